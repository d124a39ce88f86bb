"""A motor that gives less as it warms, in a run of one joint as in MuJoCo."""

from dataclasses import replace

import numpy as np
from test_one_joint import LAW, STEP, N, block, in_mujoco, run_of

from frictionjoint.effects.motor import TEMPERATURE
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.motor import Motor
from frictionjoint.simulate.one_joint import JointModel, simulate

T0, A = 30.0, 0.02
GAIN, EMF = 0.1, 0.05
EFFECT = SimulatedEffect(TEMPERATURE, (T0,), (A,))
TARGET = 0.8 * np.sin(6.0 * STEP * np.arange(N))
START = (0.3, -0.5)
CONTROL = block(KP=12.0, KD=0.1, SUPPLY=1.0, LIMIT=7.0)


def run_at(celsius):
    known = None if celsius is None else np.full(N, float(celsius))
    return replace(run_of(TARGET, START, CONTROL), temperature=known)


def test_a_run_at_the_temperature_of_its_log_is_mujocos():
    model = JointModel(LAW, [EFFECT], GAIN, EMF)
    hot = simulate(model, run_at(T0 + 25.0))
    own = in_mujoco([EFFECT], Motor(GAIN, EMF), CONTROL, TARGET, START, T0 + 25.0)
    np.testing.assert_allclose(hot, own, atol=1e-9)
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
