"""Two effects of one quantity are not lost behind a curve that takes what both explain."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.diagnose.pairs import first_of_two
from frictionjoint.diagnose.ranking import rank_all
from frictionjoint.identify.fit import fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.start import settled
from frictionjoint.measured.readers import read_log

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))

from plants.plant import simulate, write
from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

PLANT = PlantSpec(
    mass=1.0,
    length=0.2,
    inertia=0.06,
    armature=0.02,
    friction=Friction("lugre", Fs=0.6, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3),
    controller=Controller(kp=60.0, kd=3.0),
    motions=(Motion("sines", 3, 0.5, 1.0, 12.0), Motion("multisine", 4, 0.4, 1.0, 12.0)),
    instrument=Instrument(rate=500.0, counts=65536, torque_noise=0.005),
    seed=1,
)


def behind_the_curve(folder, *effects):
    """The best curve, and the effect that is preferred to it, by name."""
    paths = write(simulate(replace(PLANT, effects=effects)), folder)
    body = RigidBody(folder / "joint.xml", "joint")
    logs = prepare([read_log(path, "joint") for path in paths], body)
    logs, alone = settled(logs, fit(logs))
    ranking = rank_all(logs, alone, np.random.default_rng(0))
    curve = next(r for r in ranking.ranked if r.candidate.smooth)
    first = first_of_two(logs, alone, ranking, curve)
    return curve.name, first and first.name


def test_a_stop_beside_a_bias_is_found_behind_a_curve(tmp_path):
    stop, bias = (
        Effect("end-stop", {"at": 0.2, "stiffness": 8.0}),
        Effect("torque-bias", {"bias": 0.5}),
    )
    curve, first = behind_the_curve(tmp_path, stop, bias)
    assert curve == "torque"
    assert first == "end-stop"


def test_what_no_two_effects_explain_stays_with_the_curve(tmp_path):
    contact = Effect("stick-slip-contact", {"level": 0.2, "reach": 0.1})
    _, first = behind_the_curve(tmp_path, contact)
    assert first is None
