"""The link behind a spring or a gap is followed from the motor: it hangs where it has swung to."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from plants.plant import simulate, write
from plants.spec import Effect, Friction, Motion
from round_trip_joint import joint_trip, plant
from trial_logs import PENDULUM

from frictionjoint.effects.gear import JOINT_ELASTICITY
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.free_runs import replay


def test_a_heavy_link_comes_back_with_the_spring_it_has(tmp_path):
    seed = 200
    spec = plant("joint-elasticity", 12.0, seed)
    trip = joint_trip("joint-elasticity", tmp_path, 12.0, seed=seed)
    assert max(trip.errors.values()) < 2.0, trip.errors
    spring = spec.effects[0].parameters
    true = np.sqrt(spring["stiffness"] / spec.inertia) / (2.0 * np.pi)
    # gravity's mean stiffness would make it 0.35% more
    assert trip.first["resonance"].value == pytest.approx(true, rel=5e-4)


def lumped(mjcf):
    """An MJCF that has the rotor's inertia in its link."""
    root = ElementTree.fromstring(mjcf)
    joint, inertial = root.find(".//joint"), root.find(".//inertial")
    rotor = float(joint.attrib.pop("armature"))
    moments = [float(x) + rotor for x in inertial.get("diaginertia").split()]
    inertial.set("diaginertia", " ".join(map(str, moments)))
    return ElementTree.tostring(root, encoding="unicode")


def test_all_of_gravity_hangs_behind_a_spring_whatever_the_model_lumps_together(tmp_path):
    w = 2.0 * np.pi * 6.0
    link = PENDULUM.inertia
    spring = {"stiffness": link * w * w, "damping": 0.06 * link * w}
    motions = (Motion("multisine", 3, 0.5, 1.0, 15.0), Motion("multisine", 4, 0.4, 1.5, 15.0))
    spec = replace(
        PENDULUM,
        mass=2.5,
        length=0.15,
        armature=0.1,
        motions=motions,
        friction=Friction("lugre", Fs=0.6, Fc=0.6, Vs=0.1, sigma2=0.1, presliding=2e-3),
        effects=(Effect("joint-elasticity", spring),),
    )
    logs = [read_log(path, "joint") for path in write(simulate(spec), tmp_path)]
    mjcf = (tmp_path / "joint.xml").read_text()
    term = EffectTerm(JOINT_ELASTICITY, (5.0, 0.05))
    apart, together = (
        fit(prepare(logs, RigidBody(text, "joint")), (term,)) for text in (mjcf, lumped(mjcf))
    )
    part = link / (link + spec.armature)
    assert together.terms[0].part == pytest.approx(part, rel=0.1)
    assert together.drive_rms < 1.1 * apart.drive_rms
    assert together.terms[0].shape[0] == pytest.approx(6.0, rel=0.005)
    body = RigidBody(mjcf, "joint")
    prepared = prepare(logs, body)
    rigid, elastic = (replay(prepared, body, f).rms for f in (fit(prepared), apart))
    # a link that is locked moves as with a rigid gear
    assert elastic < 0.2 * rigid
