"""Numbers of causes through the rigid body that is linear in them: far changes as exact as near."""

import numpy as np
import pytest

from frictionjoint.robot.causes.body_inertia import BodyInertia
from frictionjoint.robot.causes.payload import Payload
from frictionjoint.robot.clock import clock
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.descend import descended
from frictionjoint.robot.found import Found
from frictionjoint.robot.inertia import possible
from frictionjoint.robot.joint import FittedJoint
from tests.arms.arm import hide_mass, hide_payload, random_arm, reread, written
from tests.arms.fitted import fitted_joints


@pytest.fixture(scope="module")
def joints() -> list[FittedJoint]:
    """An arm whose second link is three times as heavy as its model believes."""
    arm = random_arm(31, 2)
    hide_mass(arm, "link2", 3.0)
    return fitted_joints(arm, (1,), 6.0)


def found_of(joints: list[FittedJoint], *causes) -> Found:
    found = Found(Corrections.none(joints[0].alongs[0].model))
    for cause in causes:
        found = found.with_cause(cause, cause.start)
    return found


def rms(joints, found) -> list[float]:
    return [float(np.sqrt(np.mean(j.corrected(found.state).residual ** 2))) for j in joints]


def test_a_body_three_times_as_heavy_is_found_from_the_models_own(joints):
    start = found_of(joints, BodyInertia(2, "link2", "mass"))
    found = descended(joints, clock(joints), start, lambda label: False)
    assert np.exp(found.numbers[0][0]) == pytest.approx(3.0, rel=0.1)
    assert all(b < a for a, b in zip(rms(joints, start), rms(joints, found), strict=True))


def test_all_ten_parameters_find_it_too_and_stay_possible(joints):
    start = found_of(joints, BodyInertia(2, "link2", "all ten"))
    found = descended(joints, clock(joints), start, lambda label: False)
    again = [j.corrected(found.state).refitted() for j in joints]
    assert all(a.fit.rms < 0.7 * j.fit.rms for a, j in zip(again, joints, strict=True))
    assert possible(found.state.phi[2])


def test_a_start_far_off_is_no_worse_than_none(joints):
    cause = BodyInertia(2, "link2", "all ten")
    start = Found(found_of(joints).original).with_cause(cause, np.full(10, 1.5))
    nothing = found_of(joints, cause)
    at = [j.corrected(start.state) for j in joints]
    found = descended(at, clock(joints), start, lambda label: False)
    assert sum(rms(joints, found)) < sum(rms(joints, nothing))


def test_a_number_that_moves_no_torque_stays_at_nothing():
    """Of what a planar arm carries, how far out along its axes: it came to some hundred kg m."""
    arm = random_arm(31, 2)
    hide_payload(arm, 0.5, [0.02, 0.0, 0.03])
    arm.believed, arm.true = planar(arm.believed), planar(arm.true)
    joints = fitted_joints(arm, (1,), 6.0)
    start = found_of(joints, Payload(2, "link2"))
    (found,) = descended(joints, clock(joints), start, lambda label: False).numbers
    assert found[0] == pytest.approx(0.5, rel=0.1)
    assert abs(found[2]) < 1e-3


def planar(text: str) -> str:
    """An arm whose axes are all alike."""
    spec = reread(text)
    for joint in spec.joints:
        joint.axis = [0.0, 1.0, 0.0]
    return written(spec)


def test_a_payload_is_found_though_one_direction_of_its_centre_moves_no_torque_at_first():
    """About an axis along it gravity says nothing of it; only products with the others do."""
    arm = random_arm(415900170, 3)
    hide_payload(arm, 1.2, [0.02, -0.02, 0.03])
    joints = fitted_joints(arm, (1, 2), 8.0)
    _, mass, centre = arm.hidden["payload"]
    start = found_of(joints, Payload(3, "link3"))
    (found,) = descended(joints, clock(joints), start, lambda label: False).numbers
    assert found[0] == pytest.approx(mass, rel=0.02)
    assert np.linalg.norm(found[1:4] / found[0] - centre) < 2e-3
