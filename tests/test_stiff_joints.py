"""Presliding too stiff for the step: held without chatter, slipping as far as with a fine step."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj

INERTIA, STEP, FS, FC = 0.01, 1e-3, 1.5, 1.0
RATIOS = (1.0, 3.0, 8.0)  # h sqrt(K/J)


def joint(ratio, step=STEP, integrator="implicitfast"):
    K = INERTIA * (ratio / STEP) ** 2
    p = fj.FrictionParameters.symmetric(
        Fs=FS, Fc=FC, Vs=0.05, n=4.0, virgin="masing", knots=((FS / K, FS), (4 * FS / K, 2 * FS))
    )
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><option timestep="{step}" gravity="0 0 0" integrator="{integrator}"/>'
        f'<worldbody><body><joint name="j"/><inertial pos="0 0 0" mass="1" '
        f'diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body></worldbody></mujoco>'
    )
    fj.install(spec, {"j": p})
    return spec.compile()


def run(model, load, seconds, v0=0.0):
    data = mujoco.MjData(model)
    data.qvel[0] = v0
    out = []
    with fj.attach(model):
        for _ in range(round(seconds / model.opt.timestep)):
            data.qfrc_applied[0] = load(data.time, data.qpos[0])
            mujoco.mj_step(model, data)
            out.append((data.time, data.qpos[0], data.qvel[0]))
    return np.array(out).T


def slips(track):
    """Distances gone between rests under a target that moves."""
    _, q, v = track
    resting = np.abs(v) < 0.02
    edges = np.flatnonzero(np.diff(resting.astype(int)))
    gone = np.diff(q[edges])
    return gone[gone > 0.02]


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_half_the_breakaway_is_held_without_chatter(ratio, integrator):
    t, q, v = run(joint(ratio, integrator=integrator), lambda t, q: 0.5 * FS * min(1, t / 2.0), 6.0)
    late = t > 3.0
    assert np.sqrt(np.mean(v[late] ** 2)) < 1e-6
    assert abs(q[-1] - q[late][0]) < 1e-9
    K = INERTIA * (ratio / STEP) ** 2
    # what the load changes in one step acts for a whole one: h^2 K/J times as much, there and back
    change = 2 * ratio**2 * 0.5 * FS * STEP / 2.0
    assert abs(K * q[-1] - 0.5 * FS) < 0.03 * 0.5 * FS + change


@pytest.mark.parametrize("ratio", [3.0, 8.0])
def test_slips_are_as_long_as_with_a_hundredth_of_the_step(ratio):
    def spring(t, q):
        return 20.0 * (0.3 * t - q)

    coarse = slips(run(joint(ratio), spring, 4.0))
    fine = slips(run(joint(ratio, STEP / 100), spring, 2.0))
    assert len(coarse) > 5
    assert np.median(coarse) == pytest.approx(np.median(fine), rel=0.05)


@pytest.mark.parametrize("ratio", RATIOS)
def test_free_motion_gains_no_energy(ratio):
    _, _, v = run(joint(ratio), lambda t, q: 0.0, 1.0, v0=1.0)
    assert (np.diff(np.maximum.accumulate(np.abs(v)[::-1])) >= 0).all()
    assert np.abs(v).max() <= 1.0
    assert np.abs(v[-100:]).max() < 1e-6


def test_a_minute_at_rest_ends_where_it_settled():
    t, q, _ = run(joint(3.0), lambda t, q: 0.5 * FS * min(1, t / 2.0), 60.0)
    assert abs(q[-1] - q[np.searchsorted(t, 3.0)]) < 1e-9
