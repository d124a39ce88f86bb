"""Held-out logs in which the joint hardly slides or nothing drives it."""

from dataclasses import replace

import numpy as np
import pytest
from test_early_checks import stages

import frictionjoint as fj
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog

N, DT, STIFFNESS, LEVEL = 3000, 4e-3, 100.0, 0.5
JOINT = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="j" axis="0 1 0"/>
<inertial mass="1" pos="0 0 0" diaginertia="0.05 0.05 0.05"/></body></worldbody></mujoco>"""


def log(size: float, name: str) -> JointLog:
    """A bristle that slips, along two sines."""
    t = DT * np.arange(N)
    q = size * (np.sin(2.0 * np.pi * 0.3 * t) + 0.3 * np.sin(2.0 * np.pi * 0.8 * t))
    a = np.gradient(np.gradient(q, DT), DT)
    friction = stages(q, LEVEL, LEVEL / STIFFNESS)
    noise = 2e-3 * np.random.default_rng(1).standard_normal(N)
    return JointLog(name=name, joint="j", time=t, position=q, torque=0.05 * a + friction + noise)


def test_the_error_of_a_log_at_rest_is_a_part_of_what_was_measured_there() -> None:
    report = fj.close_loop([log(0.5, "slides")], JOINT, "j", [log(2e-3, "sticks")])
    held = [c for c in report.curves if c.role == "held-out"]
    assert all(c.in_motion.all() for c in held)
    whole = np.sqrt(np.mean(np.concatenate([c.measured for c in held]) ** 2))
    assert report.drive_rms("after").held_out == whole
    assert "nan" not in report.summary()


def test_a_part_that_is_held_out_with_its_drive_off_is_refused() -> None:
    whole = log(0.5, "ends")
    torque = np.where(whole.time < 0.6 * whole.time[-1], whole.torque, 0.0)
    with pytest.raises(LogError, match=r"ends.*held out: the drive is exactly 0"):
        fj.close_loop([replace(whole, torque=torque)], JOINT, "j", 0.3)


def test_a_log_that_is_held_out_without_motion_is_refused() -> None:
    still = replace(log(0.5, "still"), position=np.full(N, 0.1))
    with pytest.raises(LogError, match=r"still, held out.*stands still"):
        fj.close_loop([log(0.5, "slides")], JOINT, "j", [still])


def switched_off(velocity: np.ndarray, begin: float, end: float) -> JointLog:
    """A joint whose drive is off for a while, whatever its velocity is then."""
    t = DT * np.arange(N)
    q, a = np.cumsum(velocity) * DT, np.gradient(velocity, DT)
    torque = np.where((t > begin) & (t < end), 0.0, 0.05 * a + LEVEL * np.sign(velocity))
    return JointLog(name="off", joint="j", time=t, position=q, torque=torque)


def test_a_part_in_which_another_drive_turns_the_joint_is_left_out_and_said() -> None:
    t = DT * np.arange(N)
    found = fj.identify([switched_off(4.0 * np.sin(np.pi * t), 4.0, 8.0)], JOINT, "j")
    (said,) = [n for n in found.notes if "another drive moves it" in n]
    assert said.startswith("off: 4.00")
    assert found.parameters.Fc_pos == pytest.approx(LEVEL, rel=0.03)
    assert found.torque_rms < 0.1 * LEVEL


def test_a_joint_that_coasts_tells_its_friction() -> None:
    t = DT * np.arange(N)
    driven, slow = 30.0 + 5.0 * np.sin(np.pi * t), 30.0 - LEVEL / 0.05 * (t - 4.0)
    velocity = np.select([t < 4.0, t < 6.5], [driven, slow], 5.0 + 2.0 * np.sin(np.pi * (t - 6.5)))
    found = fj.identify([switched_off(velocity, 4.0, 6.5)], JOINT, "j")
    assert not [n for n in found.notes if "another drive" in n]
