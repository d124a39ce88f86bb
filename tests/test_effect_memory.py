"""What an effect remembers in a simulation is what it remembers along a log of the same motion."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects import dwell_time, frictional_lag, warm_up_drift
from frictionjoint.effects.kernel import MEMORY, effect_torque
from frictionjoint.effects.signals import DT, N_SIGNALS, TIME, H, Q, V
from frictionjoint.joint_friction import SimulatedEffect

FC, STEP = 1.0, 1e-3
FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=FC, Vs=0.05, knots=((1e-3, 3.2),))
# the first two begin with a memory that is not zero
EFFECTS = {
    "dwell-time": SimulatedEffect(dwell_time.EFFECT, (0.05, 0.01, 1e-3), (0.4,)),
    "frictional-lag": SimulatedEffect(frictional_lag.EFFECT, (0.05, 0.02, 1e-3), (0.4,)),
    "warm-up-drift": SimulatedEffect(warm_up_drift.BY_LOSS, (5.0, 0.1), (0.4, 0.1)),
    "warm-up-drift by the whole loss": SimulatedEffect(
        warm_up_drift.BY_WHOLE_LOSS, (0.2, 0.3, 5.0), (0.4, 0.1)
    ),
}
JOINT = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"


@pytest.mark.parametrize("name", EFFECTS)
@pytest.mark.parametrize("backend", ["native", "python"])
def test_simulated_and_logged_effects_agree_from_the_first_sample_on(name, backend):
    effect = EFFECTS[name]
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": FRICTION}, {"j": [effect]})
    spec.option.timestep = STEP
    m = spec.compile()
    data = mujoco.MjData(m)
    numbers, memory, sig = np.array([*effect.shape, *effect.coefficients]), np.zeros(MEMORY), None
    found, expected = [], []
    with fj.attach(m, backend):
        for k in range(60):
            data.time = k * STEP
            data.qpos[0], data.qvel[0] = 0.02 * np.sin(0.1 * k), 2.0 * np.cos(0.1 * k)
            mujoco.mj_forward(m, data)
            read = fj.torque(m, data)["j"]
            sig = np.zeros(N_SIGNALS)
            sig[TIME], sig[Q], sig[V] = data.time, data.qpos[0], data.qvel[0]
            sig[DT] = STEP if k else 0.0
            sig[H] = read.hysteresis / FC
            found.append(read.effects[effect.effect.name])
            expected.append(effect_torque(effect.effect.effect_id, numbers, 0, sig, memory, 0))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    assert np.ptp(expected) > 1e-3
