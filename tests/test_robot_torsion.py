"""A second encoder: stiffness, backlash, hysteresis between motor and link of simulated gears."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.robot.torsion import torsion

STIFFNESS, RATIO = 2000.0, 50.0
PLANT = """
<mujoco><option timestep="2e-4"/><worldbody>
  <body><joint name="motor" axis="0 1 0" armature="0.3" damping="1"/>
    <inertial mass="1e-3" pos="0 0 0" diaginertia="1e-3 1e-3 1e-3"/></body>
  <body><joint name="link" axis="0 1 0"/>
    <inertial mass="3" pos="0 0 -0.4" diaginertia="0.1 0.1 0.1"/></body>
</worldbody></mujoco>
"""
BELIEVED = """
<mujoco><worldbody><body><joint name="link" axis="0 1 0" armature="0.3"/>
  <inertial mass="3" pos="0 0 -0.4" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>
"""


def log_of(
    gap: float = 0.0, rub: float = 0.0, seconds: float = 12.0, later: float = 0.0
) -> JointLog:
    """A pendulum behind a spring with a gap and a slider of level `rub`, N m, beside the spring.

    The motor's encoder is read `later` than the link's, s.
    """
    model = mujoco.MjModel.from_xml_string(PLANT)
    data, rows, slide = mujoco.MjData(model), [], 0.0
    for k in range(round(seconds / model.opt.timestep)):
        t = k * model.opt.timestep
        target = 1.2 * np.sin(1.1 * t) + 0.5 * np.sin(2.9 * t)
        rate = 1.32 * np.cos(1.1 * t) + 1.45 * np.cos(2.9 * t)
        q, v = data.qpos, data.qvel
        twist = q[0] - q[1]
        spring = STIFFNESS * (twist - np.clip(twist, -gap / 2, gap / 2))
        slide = float(np.clip(slide + 2e4 * (v[0] - v[1]) * model.opt.timestep, -rub, rub))
        passed = spring + slide + 4.0 * (v[0] - v[1])
        drive = 400.0 * (target - q[0]) + 40.0 * (rate - v[0])
        if k % 10 == 0:
            rows.append((t, q[1], RATIO * q[0] + 0.7, drive))
        data.qfrc_applied[:] = drive - passed, passed
        mujoco.mj_step(model, data)
    time, link, motor, drive = np.array(rows).T
    motor = np.interp(time + later, time, motor)
    return JointLog(
        name="log", joint="link", time=time, position=link, motor_position=motor, torque=drive
    )


def found_in(log: JointLog):
    return torsion([log], prepare([log], RigidBody(BELIEVED, "link")))


def test_a_stiff_gear_has_its_stiffness_and_nothing_else():
    found = found_in(log_of())
    assert found.ratio == pytest.approx(RATIO, rel=1e-2)
    assert found.stiffness.value == pytest.approx(STIFFNESS, rel=0.05)
    assert found.backlash is None
    assert found.hysteresis is None


def test_a_link_whose_position_is_older_is_no_torsion():
    found = found_in(log_of(later=3e-3))
    assert found.link_position_older.value == pytest.approx(3e-3, rel=0.05)
    assert found.stiffness.value == pytest.approx(STIFFNESS, rel=0.05)
    assert found.hysteresis is None


def test_backlash_has_its_width():
    found = found_in(log_of(gap=0.006))
    assert found.backlash.value == pytest.approx(0.006, rel=0.1)
    assert found.stiffness.value == pytest.approx(STIFFNESS, rel=0.1)
    assert found.hysteresis is None


def test_what_rubs_beside_the_spring_makes_the_twist_lag():
    found = found_in(log_of(rub=1.5))
    # at the same torque the twist differs by twice the level over the stiffness
    assert found.hysteresis.value == pytest.approx(2 * 1.5 / STIFFNESS, rel=0.25)
    assert found.backlash is None


def test_a_position_computed_from_the_other_tells_nothing():
    log = log_of(seconds=4.0)
    assert found_in(replace(log, motor_position=RATIO * log.position)) is None
