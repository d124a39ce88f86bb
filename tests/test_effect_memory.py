"""What an effect remembers in a simulation is what it remembers along a log of the same motion."""

import mujoco
import numpy as np
import pytest
from acting import acting, name, torques

import frictionjoint as fj
from frictionjoint.effects.kernel import MEMORY, effect_torque
from frictionjoint.effects.signals import DT, N_SIGNALS, ONSET, TIME, H, Q, V

FC, STEP = 1.0, 1e-3
FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=FC, Vs=0.05, knots=((1e-3, 3.2),))
REMEMBER = ("dwell-time", "frictional-lag", "warm-up-drift", "position-periodic")
JOINT = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"


@pytest.mark.parametrize("kind", [e for e in torques() if e.name in REMEMBER], ids=name)
@pytest.mark.parametrize("backend", ["native", "python"])
def test_simulated_and_logged_effects_agree_from_the_first_sample_on(kind, backend):
    effect = acting(kind)
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": FRICTION}, {"j": [effect]})
    spec.option.timestep = STEP
    data = mujoco.MjData(m := spec.compile())
    numbers, memory = np.array([*effect.shape, *effect.coefficients]), np.zeros(MEMORY)
    found, expected = [], []
    with fj.attach(m, backend):
        for k in range(60):
            data.time = k * STEP
            data.qpos[0], data.qvel[0] = 0.02 * np.sin(0.1 * k), 2.0 * np.cos(0.1 * k)
            mujoco.mj_forward(m, data)
            read = fj.torque(m, data)["j"]
            sig = np.zeros(N_SIGNALS)
            sig[[TIME, Q, V, H]] = data.time, data.qpos[0], data.qvel[0], read.hysteresis / FC
            sig[DT], sig[ONSET] = STEP if k else 0.0, FC * 1e-3 / 3.2
            found.append(read.effects[effect.effect.name])
            expected.append(effect_torque(effect.effect.effect_id, numbers, 0, sig, memory, 0))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    assert np.ptp(expected) > 1e-3
