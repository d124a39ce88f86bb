"""Corrections of a rigid-body model: the search's columns and load against the corrected MJCF."""

import itertools
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from arms.arm import random_arm
from arms.run import motion

from frictionjoint.effects.signals import GEAR, LOAD
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.model_files import read_spec
from frictionjoint.robot.causes.base_tilt import BaseTilt
from frictionjoint.robot.causes.body_inertia import BodyInertia
from frictionjoint.robot.causes.catalogue import catalogue
from frictionjoint.robot.causes.of_joint import JointOffset, RotorInertia
from frictionjoint.robot.causes.payload import Payload
from frictionjoint.robot.corrected_torque import Along
from frictionjoint.robot.corrections import Corrections, Shaft, tendon_polynomial, write_corrections

JOINTS = ("j1", "j2", "j3")


@pytest.fixture(scope="module")
def arm() -> str:
    return random_arm(5, 3).believed


@pytest.fixture(scope="module")
def logs() -> dict[str, JointLog]:
    time = np.arange(0.0, 3.0, 4e-3)
    q, _, _ = motion(np.random.default_rng(0), time, 3)
    tracks = dict(zip(JOINTS, q.T, strict=True))
    rng = np.random.default_rng(1)
    return {
        name: JointLog(
            name="log",
            joint=name,
            time=time,
            position=tracks[name],
            torque=rng.normal(size=len(time)),
            other_positions={n: x for n, x in tracks.items() if n != name},
        )
        for name in JOINTS
    }


CAUSES = {
    "payload": (Payload(3, "link3", 10.0), [0.7, 0.05, -0.02, 0.03, 1e-3]),
    "mass": (BodyInertia(2, "link2", "mass"), [0.3]),
    "gyration": (BodyInertia(2, "link2", "mass, centre, gyration"), [0.2, 0.03, -0.01, 0.02, -0.1]),
    "all ten": (BodyInertia(3, "link3", "all ten"), list(0.1 * np.arange(-5, 5))),
    "rotor": (RotorInertia("j2", armature=0.01), [0.2]),
    "tilt": (BaseTilt(), [0.1, -0.05]),
    "offset": (JointOffset("j2"), [0.07]),
}


def test_an_arm_carries_no_more_than_its_own_mass(arm):
    model = mujoco.MjModel.from_xml_string(arm)
    causes = catalogue(model, JOINTS, JOINTS, dict.fromkeys(JOINTS, np.ones(3)))
    (payload,) = (c for c in causes if isinstance(c, Payload))
    least, most = payload.bounds[0]
    assert 0.0 < least < 1e-4
    assert most == pytest.approx(model.body_mass.sum())


@pytest.mark.parametrize("kind", CAUSES)
@pytest.mark.parametrize("joint", JOINTS)
def test_load_under_corrections_is_that_of_the_corrected_model(arm, logs, kind, joint):
    cause, x = CAUSES[kind]
    body = RigidBody(arm, joint)
    prepared = prepare([logs[joint]], body)
    (segment,) = prepared.segments
    state = cause.applied(Corrections.none(body.model), np.array(x))
    found = Along(body, segment, state).segment(segment)
    spec = read_spec(arm)
    write_corrections(spec, state)
    other = prepare([logs[joint]], RigidBody(spec.to_xml(), joint), prepared.band).segments[0]
    for column in (LOAD, GEAR):
        size = np.abs(other.signals[:, LOAD]).max()
        # six digits of an MJCF's numbers
        assert np.abs(found.signals[:, column] - other.signals[:, column]).max() < 1e-4 * size


def test_a_shafts_torque_is_the_tendons(arm, logs):
    """All but Coulomb friction through MuJoCo's tendon; that is added to it."""
    concave = 0.4 if tendon_polynomial() else 0.0
    even = Shaft(("j2", "j3"), -1.0, 2.0, numbers=(0.3, 0.2, concave, 0.05, 0.0, 0.0))
    wavy = replace(even, waves=7.0, numbers=(*even.numbers[:4], 0.1, -0.2))
    for joint, shaft in itertools.product(JOINTS, (even, wavy)):
        body = RigidBody(arm, joint)
        prepared = prepare([logs[joint]], body)
        (segment,) = prepared.segments
        state = replace(Corrections.none(body.model), shafts=(shaft,))
        found = Along(body, segment, state).segment(segment)
        spec = read_spec(arm)
        write_corrections(spec, state)
        other = RigidBody(spec.to_xml(), joint)
        expected = prepare([logs[joint]], other, prepared.band).segments[0].signals[:, LOAD]
        assert np.abs(found.signals[:, LOAD] - expected).max() < 1e-4 * np.abs(expected).max()
    assert np.abs(segment.balanced(expected[:, None])).max() > 0.0
