"""Presliding too stiff for the step: held without chatter, slipping as far as with a fine step."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from tests.standing import plain_mass

INERTIA, STEP, FS, FC = 0.01, 1e-3, 1.5, 1.0


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


def arm(ratio, h=1e-3, contact=False):
    """Seven coupled hinges, h sqrt(K/J) as given at each; J is what the free arm has there."""
    parts, ends = "", ""
    for i in range(7):
        parts += (
            f'<body pos="0 0 {0.2 if i else 0}"><joint name="j{i}" armature="0.005" '
            f'axis="{("0 0 1", "0 1 0", "1 0 0")[i % 3]}"/><geom type="capsule" mass="1.5" '
            'fromto="0 0 0 0 0 0.2" size="0.03" contype="0" conaffinity="0"/>'
        )
        ends += "</body>"
    parts += '<geom type="sphere" pos="0 0 0.2" size="0.03" mass="0.2"/>'
    text = f'<mujoco><option timestep="{h}" gravity="0 0 0"/><worldbody>{parts}{ends}'
    posture = np.linspace(0.0, 0.6, 7)
    free = mujoco.MjModel.from_xml_string(text + "</worldbody></mujoco>")
    data = mujoco.MjData(free)
    data.qpos[:] = posture
    mujoco.mj_forward(free, data)
    M = plain_mass(free, posture)
    if contact:
        floor = data.geom_xpos[-1, 2] - 0.0299
        text += f'<geom type="plane" size="5 5 0.1" pos="0 0 {floor}"/>'
    spec = mujoco.MjSpec.from_string(text + "</worldbody></mujoco>")
    laws = {}
    for i, J in enumerate(1.0 / np.diag(np.linalg.inv(M))):
        z = 10.0 / ((ratio / h) ** 2 * J)
        knots = ((z, 10.0), (4 * z, 20.0), (10 * z, 22.0))
        laws[f"j{i}"] = fj.FrictionParameters.symmetric(
            Fs=10.0, Fc=7.0, Vs=0.05, sigma2=0.1, n=4.0, knots=knots
        )
    fj.install(spec, laws)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = posture
    return model, data


def held(model, data, seconds=3.0):
    """rms velocity and creep in the last second under half the breakaway torque at every joint."""
    squares, start, touching = [], None, 0
    with fj.attach(model):
        while data.time < seconds:
            data.qfrc_applied[:] = 5.0 * min(1.0, 2 * data.time) * (-1.0) ** np.arange(7)
            mujoco.mj_step(model, data)
            if data.time > seconds - 1.0:
                start = data.qpos.copy() if start is None else start
                squares.append(np.mean(data.qvel**2))
                touching += data.ncon
    return np.mean(squares) ** 0.5, np.abs(data.qpos - start).max(), touching


@pytest.mark.parametrize("ratio", [1, 3, 8, 30])
def test_an_arm_is_pushed_as_far_as_with_a_fraction_of_the_step(ratio):
    """A controller takes every joint to another position, where it comes to rest."""
    tracks = []
    for parts in (1, 20):
        model, data = arm(ratio)
        model.opt.timestep /= parts
        start, track = data.qpos.copy(), []
        with fj.attach(model):
            while data.time < 1.0 - 1e-9:
                target = start + 0.5 * min(1.0, 2.0 * data.time) * (-1.0) ** np.arange(7)
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
