"""Joints that a tendon or an equality constraint of the user's model couples."""

import mujoco
import numpy as np
import pytest
from arms.arm import random_arm
from arms.fitted import joint_logs

from frictionjoint.errors import ModelError
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.robot.joint import first_fit


def with_belt(mjcf: str) -> str:
    """A model with a tendon whose Coulomb friction acts on the sum of two joints' motion."""
    spec = mujoco.MjSpec.from_string(mjcf)
    belt = spec.add_tendon(name="belt", frictionloss=0.1)
    belt.wrap_joint("j1", 1.0)
    belt.wrap_joint("j2", 1.0)
    return str(spec.to_xml())


def test_friction_of_a_tendon_in_the_model_is_not_taken_for_a_joints():
    arm = random_arm(771, 2)
    arm.believed, arm.true = with_belt(arm.believed), with_belt(arm.true)
    for level, (name, logs) in zip(arm.level, joint_logs(arm, (1,), 8.0).items(), strict=True):
        found = first_fit(logs, arm.believed, name, None)
        assert law_parameters(found.fit).Fc_pos == pytest.approx(level, rel=0.1)
        # the constraint of MuJoCo turns over a little before the velocity does
        assert found.rms < 0.1 * np.std(logs[0].torque)


def test_a_joint_held_by_an_equality_constraint_is_refused():
    mjcf = random_arm(771, 2).believed.replace(
        "</mujoco>", '<equality><joint joint1="j2" joint2="j1"/></equality></mujoco>'
    )
    with pytest.raises(ModelError, match=r"couples it to 'j2'.*remove the constraint"):
        RigidBody(mjcf, "j1")
