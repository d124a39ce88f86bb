"""Numbers of causes through the rigid body that is linear in them: far changes as exact as near."""

import numpy as np
import pytest
from arms.arm import hide_mass, hide_payload, random_arm
from arms.fitted import fitted_joints

from frictionjoint.robot.causes.body_inertia import BodyInertia
from frictionjoint.robot.causes.cause import Found
from frictionjoint.robot.causes.payload import Payload
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.fit_causes import fitted_causes
from frictionjoint.robot.joint import FittedJoint


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
    found = fitted_causes(joints, Clock(joints), start, lambda label: False)
    assert np.exp(found.numbers[0][0]) == pytest.approx(3.0, rel=0.1)
    assert all(b < a for a, b in zip(rms(joints, start), rms(joints, found), strict=True))


def test_a_payload_is_found_though_one_direction_of_its_centre_moves_no_torque_at_first():
    """About an axis along it gravity says nothing of it; only products with the others do."""
    arm = random_arm(415900170, 3)
    hide_payload(arm, 1.2, [0.02, -0.02, 0.03])
    joints = fitted_joints(arm, (1, 2), 8.0)
    _, mass, centre = arm.hidden["payload"]
    start = found_of(joints, Payload(3, "link3", 10.0))
    (found,) = fitted_causes(joints, Clock(joints), start, lambda label: False).numbers
    assert found[0] == pytest.approx(mass, rel=0.02)
    assert np.linalg.norm(found[1:4] / found[0] - centre) < 2e-3
