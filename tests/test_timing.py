"""Times within a sample that no log tells: they pass for no inertia and no friction."""

import mujoco
import numpy as np
import pytest
from led import led

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import ConstraintShape, start_of
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import TargetTiming, age_of
from frictionjoint.measured.log import JointLog
from frictionjoint.rivals import StaticParameters

PD = Controller(output="torque_nm", kp=25.0, kd=0.8)
# s: of a plant, whose controller ticks with it
TICK, SECONDS = 2e-3, 10.0
MODEL = """<mujoco><compiler angle="radian"/><option timestep="0.002"/><worldbody><body>
<joint name="j" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.02"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="4e-3 4e-3 1e-3"/></body></worldbody></mujoco>"""
LINES = ((0.5, 0.7), (0.2, 2.3), (0.1, 3.7))


def log_of(seed: int, every: int = 1, held: bool = False) -> JointLog:
    """The joint led along sines by its controller; targets and positions are logged.

    Args:
        every: how many ticks a row. held: whether a target is held from row to row.
    """
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(MODEL)
    time = TICK * np.arange(int(SECONDS / TICK))
    phases = rng.uniform(0.0, 6.0, len(LINES))
    lines = [
        a * np.sin(2.0 * np.pi * f * time + p) for (a, f), p in zip(LINES, phases, strict=True)
    ]
    target = np.sum(lines, axis=0)
    if held:
        target = np.repeat(target[::every], every)[: len(time)]
    _, position = led(model, target, PD.kp, PD.kd)
    position += 2e-5 * rng.standard_normal(len(time))
    rows = slice(None, None, every)
    time, position, target = time[rows], position[rows], target[rows]
    return JointLog(name=f"log{seed}", joint="j", time=time, position=position, target=target)


def test_a_velocity_that_is_late_is_no_inertia():
    """MuJoCo's is that of the middle of the last step: 0.0015 kg m^2 of 0.034 were missing."""
    found = trace(prepare([log_of(1), log_of(2)], RigidBody(MODEL, "j"), controller=PD))
    assert not [f.term.name for f in found.findings]
    assert not found.unexplained
    assert 0.0 < abs(age_of(found.final.terms)) <= TICK


@pytest.mark.parametrize("held", [True, False], ids=["held", "moves on"])
def test_a_target_between_the_rows_of_a_log_is_no_viscous_friction(held):
    """Half a row of 10 ms late, kp times that would be 0.125 N m s/rad: more than half of it."""
    logs = [log_of(seed, every=5, held=held) for seed in (1, 2)]
    prepared = prepare(logs, RigidBody(MODEL, "j"), controller=PD)
    found = fit(prepared, forms=(ConstraintShape(start_of(StaticParameters)),))
    assert found.coefficient("sigma2") == pytest.approx(0.2, abs=0.02)
    (timing,) = [t for t in found.terms if isinstance(t, TargetTiming)]
    # MuJoCo's position is half a tick ahead of what a held torque makes it
    expected = -0.5 * (TICK if held else timing.sample)
    assert timing.shape[0] == pytest.approx(expected, abs=0.03 * timing.sample)
