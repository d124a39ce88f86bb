"""A controller's damping, by a velocity that it read within a sample: no inertia of the joint."""

import mujoco
import numpy as np

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import timed
from frictionjoint.identify.terms import EffectTerm, Timing, age_of
from frictionjoint.measured.log import JointLog

PD = Controller(output="torque_nm", kp=25.0, kd=0.8)
# s: of a plant, whose controller ticks with it
TICK = 2e-3
MODEL = """<mujoco><compiler angle="radian"/><option timestep="0.002"/><worldbody><body>
<joint name="j" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.02"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="4e-3 4e-3 1e-3"/></body></worldbody></mujoco>"""
LINES = ((0.5, 0.7), (0.2, 2.3), (0.1, 3.7))


def led(seed: int, seconds: float = 10.0) -> JointLog:
    """The joint led along sines by its controller; targets and positions are logged."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    time = TICK * np.arange(int(seconds / TICK))
    phases = rng.uniform(0.0, 6.0, len(LINES))
    lines = [
        a * np.sin(2.0 * np.pi * f * time + p) for (a, f), p in zip(LINES, phases, strict=True)
    ]
    target, position = np.sum(lines, axis=0), np.empty_like(time)
    for k in range(len(time)):
        position[k] = data.qpos[0]
        data.qfrc_applied[0] = PD.kp * (target[k] - data.qpos[0]) - PD.kd * data.qvel[0]
        mujoco.mj_step(model, data)
    position += 2e-5 * rng.standard_normal(len(time))
    return JointLog(name=f"log{seed}", joint="j", time=time, position=position, target=target)


def test_a_velocity_that_is_late_is_no_inertia():
    """MuJoCo's is that of the middle of the last step: 0.0015 kg m^2 of 0.034 were missing."""
    found = trace(prepare([led(1), led(2)], RigidBody(MODEL, "j"), controller=PD))
    assert not [f.term.name for f in found.findings]
    assert not found.unexplained
    assert 0.0 < abs(age_of(found.final.terms)) <= TICK


def test_an_inertia_that_is_searched_for_is_beside_no_age():
    prepared = prepare([led(1, 3.0)], RigidBody(MODEL, "j"), controller=PD)
    (alone,) = timed(prepared, ())
    assert isinstance(alone, Timing)
    assert len(alone.shape) == 2
    inertia = EffectTerm(next(e for e in CATALOGUE if e.is_inertia))
    _, beside = timed(prepared, (inertia,))
    assert len(beside.shape) == 1
