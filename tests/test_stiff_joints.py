"""Presliding too stiff for the step: held without chatter, slipping as far as with a fine step."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.rivals import LuGreParameters
from tests.seven_links import POSTURE, STEP, stiff_arm
from tests.standing import one_joint

INERTIA, FS, FC = 0.01, 1.5, 1.0


def joint(ratio, step=STEP):
    K = INERTIA * (ratio / STEP) ** 2
    p = fj.FrictionParameters.symmetric(
        Fs=FS, Fc=FC, Vs=0.05, n=4.0, virgin="masing", knots=((FS / K, FS), (4 * FS / K, 2 * FS))
    )
    spec = mujoco.MjSpec.from_string(one_joint(INERTIA, step))
    fj.install(spec, {"j": p})
    return spec.compile()


def run(model, load, seconds):
    data, out = mujoco.MjData(model), []
    with fj.attach(model):
        for _ in range(round(seconds / model.opt.timestep)):
            data.qfrc_applied[0] = load(data.time, data.qpos[0])
            mujoco.mj_step(model, data)
            out.append((data.time, data.qpos[0], data.qvel[0]))
    return np.array(out).T


def slips(track):
    """Distances gone between rests under a target that moves, and the times between them."""
    t, q, v = track
    resting = np.abs(v) < 0.02
    edges = np.flatnonzero(np.diff(resting.astype(int)))
    gone = np.diff(q[edges])
    return gone[gone > 0.02], np.diff(t[edges[:-1]][gone > 0.02])


@pytest.mark.parametrize("ratio", [1.0, 3.0, 8.0, 30.0])
def test_slips_are_as_long_and_as_frequent_as_with_a_hundredth_of_the_step(ratio):
    def spring(t, q):
        return 20.0 * (0.3 * t - q)

    coarse = slips(run(joint(ratio), spring, 3.0))
    fine = slips(run(joint(ratio, STEP / 100), spring, 1.2))
    assert len(coarse[0]) > 5
    for found, wanted in zip(coarse, fine, strict=True):
        assert np.median(found) == pytest.approx(np.median(wanted), rel=0.03)


@pytest.mark.parametrize("ratio", [1, 3, 8, 30])
def test_an_arm_is_pushed_as_far_as_with_a_fraction_of_the_step(ratio):
    """A controller takes every joint to another position, where it comes to rest."""
    tracks = []
    for parts in (1, 20):
        model = stiff_arm(ratio)
        model.opt.timestep /= parts
        data, track = mujoco.MjData(model), []
        data.qpos[:] = POSTURE
        with fj.attach(model):
            while data.time < 1.0 - 1e-9:
                target = POSTURE + 0.5 * min(1.0, 2.0 * data.time) * (-1.0) ** np.arange(8)
                for _ in range(parts):
                    data.qfrc_applied[:] = 100.0 * (target - data.qpos) - 3.0 * data.qvel
                    mujoco.mj_step(model, data)
                track.append(data.qpos.copy())
        tracks.append(np.array(track))
    coarse, fine = tracks
    travel = np.abs(fine[-1] - fine[0])
    assert (travel > 0.3).all()
    rms = np.sqrt(np.mean((coarse - fine) ** 2, axis=0))
    assert (rms < 0.01 * travel).all()


@pytest.mark.parametrize("law", ["ganseman1997", "lampaert2002", "lugre"])
def test_a_light_joint_creeps_below_breakaway_as_with_a_fine_step(law):
    force, turn = (0.42, 12.0 * np.pi) if law == "ganseman1997" else (0.35, 6.0 * np.pi)
    levels, ends = {"Fs": 1.0, "Fc": 0.3, "Vs": 0.5}, []
    p = LuGreParameters.symmetric(**levels, sigma0=1e3)
    if law != "lugre":
        p = fj.FrictionParameters.symmetric(**levels, stiffness=1e3, variant=law)

    def load(t, q):
        return min(0.5, 0.5 * t) + force * np.sin(turn * t)

    for step in (1e-2, 5e-4):  # h sqrt(K/J) is 10 and 0.5
        spec = mujoco.MjSpec.from_string(one_joint(1e-3, step))
        fj.install(spec, {"j": p})
        ends.append(run(spec.compile(), load, 3.0)[1][-1])
    assert ends[0] == pytest.approx(ends[1], rel=0.1)
