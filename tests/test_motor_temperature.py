"""A motor that gives less as it warms, in a run of one joint as in MuJoCo."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from test_one_joint import JOINT, LAW, MODEL, STEP, N, block

from frictionjoint.control import kernel as k
from frictionjoint.effects import motor_temperature
from frictionjoint.identify.joint_load import load_of
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.motor import Motor, add_motor
from frictionjoint.simulate.one_joint import JointModel, Run, simulate
from frictionjoint.simulate.thermal import set_temperature, temperature

T0, A = 30.0, 0.02
GAIN, EMF = 0.1, 0.05
EFFECT = SimulatedEffect(motor_temperature.EFFECT, (T0,), (A,))
TARGET = 0.8 * np.sin(6.0 * STEP * np.arange(N))
CONTROL = block(KP=12.0, KD=0.1, SUPPLY=1.0, LIMIT=7.0)


def run_at(celsius):
    return Run(
        step=STEP,
        target=TARGET,
        supply=np.ones(N),
        on=np.ones(N, dtype=bool),
        start=(0.3, -0.5),
        load=load_of(RigidBody(MODEL, JOINT)),
        block=CONTROL,
        temperature=None if celsius is None else np.broadcast_to(float(celsius), N).copy(),
    )


def in_mujoco(celsius):
    spec = mujoco.MjSpec.from_file(str(MODEL))
    add_motor(spec, JOINT, Motor(GAIN, EMF))
    install(spec, {JOINT: LAW}, {JOINT: [EFFECT]})
    model = spec.compile()
    model.opt.timestep = STEP
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = 0.3, -0.5
    S, found = np.zeros(k.STATE), np.empty(N)
    with attach(model):
        mujoco.mj_forward(model, data)
        set_temperature(model, data, JOINT, celsius)
        assert temperature(model, data) == {JOINT: pytest.approx(celsius)}
        for i in range(N):
            found[i] = data.qpos[0]
            data.ctrl[0] = k.tick(CONTROL, S, i * STEP, TARGET[i], *data.qpos, *data.qvel, 1.0)
            mujoco.mj_step(model, data)
    return found


def test_a_run_at_the_temperature_of_its_log_is_mujocos():
    model = JointModel(LAW, [EFFECT], GAIN, EMF)
    hot = simulate(model, run_at(T0 + 25.0))
    np.testing.assert_allclose(hot, in_mujoco(T0 + 25.0), atol=1e-9)
    assert np.abs(hot - simulate(model, run_at(None))).max() > 0.01


def test_a_temperature_that_changes_is_followed_and_an_unknown_one_rests():
    model = JointModel(LAW, [EFFECT], GAIN, EMF)
    cold, hot = (simulate(model, run_at(T0 + d)) for d in (0.0, 25.0))
    np.testing.assert_array_equal(cold, simulate(model, run_at(None)))
    warming = replace(run_at(T0), temperature=np.where(np.arange(N) < N // 2, T0, T0 + 25.0))
    found = simulate(model, warming)
    np.testing.assert_array_equal(found[: N // 2 + 1], cold[: N // 2 + 1])
    assert np.abs(found - cold)[-1000:].max() > 0.01
    np.testing.assert_allclose(found[-500:], hot[-500:], atol=2e-3)
