"""A gap of several time steps is another state, not motion: the memory starts afresh there."""

import mujoco
import numpy as np
import pytest
from mujoco import rollout
from test_state import ARM, FRICTION, model, run

import frictionjoint as fj
from frictionjoint.effects import warm_up_drift
from frictionjoint.joint_friction import SimulatedEffect

FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS
APPLIED = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)


def states_of(m, times, rng):
    """Full-physics states of joints anywhere, at these times."""
    data, found = mujoco.MjData(m), []
    for t in times:
        data.time = t
        data.qpos[:], data.qvel[:] = rng.uniform(-1, 1, 2), rng.uniform(-0.5, 0.5, 2)
        state = np.zeros(mujoco.mj_stateSize(m, FULL))
        mujoco.mj_getState(m, data, state, FULL)
        found.append(state)
    return np.array(found)


@pytest.mark.parametrize("integrator", ["implicitfast", "RK4"])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("steps", [1, 50])
def test_rollouts_from_states_of_increasing_time_equal_fresh_ones(integrator, threads, steps):
    m = model(integrator)
    starts = states_of(m, 0.1 * np.arange(64), np.random.default_rng(5))
    control = np.tile([0.8, -0.4], (64, steps, 1))
    with fj.attach(m):
        pool = [mujoco.MjData(m) for _ in range(threads)]
        found, _ = rollout.rollout(m, pool, starts, control, control_spec=APPLIED)
        for start, reached in zip(starts, found[:, -1], strict=True):
            fresh = mujoco.MjData(m)
            mujoco.mj_setState(m, fresh, start, FULL)
            fresh.qfrc_applied[:] = control[0, 0]
            mujoco.mj_step(m, fresh, nstep=steps)
            np.testing.assert_array_equal(reached[1:3], fresh.qpos)


@pytest.mark.parametrize("leap", [-0.5, 0.5])
def test_what_an_effect_remembers_starts_afresh_too(leap):
    spec = mujoco.MjSpec.from_string(ARM.format(integrator="implicitfast"))
    warming = SimulatedEffect(warm_up_drift.BY_LOSS, (5.0, 0.1), (2.0, 0.1))
    fj.install(spec, {"a": FRICTION}, {"a": [warming]})
    m = spec.compile()
    with fj.attach(m):
        data = mujoco.MjData(m)
        run(m, data, 300)
        assert np.count_nonzero(data.userdata[-7:]), "nothing remembered: it would prove nothing"
        data.time += leap
        fresh = mujoco.MjData(m)
        fresh.time, fresh.qpos[:], fresh.qvel[:] = data.time, data.qpos, data.qvel
        np.testing.assert_array_equal(run(m, data, 100), run(m, fresh, 100))
