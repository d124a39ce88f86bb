"""Arms in mujoco_warp: stiff joints that are coupled, and every effect, as in MuJoCo itself.

The worlds of a test have their own parameters, so that one run serves many arms.
"""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from acting import ARM, LAW, acting, arm, ctrl, name, natively, torques

import frictionjoint as fj
from frictionjoint.effects import measurement_delay
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.gear import BACKLASH, JOINT_ELASTICITY
from frictionjoint.errors import ModelError
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.refine.posterior import Posterior
from frictionjoint.simulate.carrier import read_friction
from tests.seven_links import FS, POSTURE, STEP, free_inertias, stiff_arm

mjw = pytest.importorskip("mujoco_warp")
wp = pytest.importorskip("warp")
from frictionjoint.simulate.warp import attach_warp  # noqa: E402

PUSH = 3.0  # N, to and fro
EPS = 2.0**-24  # half a unit in the last place of a single float, relative
# what adds a torque
COLUMNS = [e for e in torques() if e.coefficients]


def held_load(k: int) -> np.ndarray:
    return np.float32(0.5 * FS * min(1.0, k / 300) * (-1.0) ** np.arange(8))


@pytest.fixture(scope="module")
def held():
    """Arms held at 1, 3, 8 by ratio, 8 again, forgotten after 350 steps, and one of which every
    second joint is stiff: here and natively.

    Positions and velocities, shape (steps, worlds, 16).
    """
    ratios, steps = ((1.0,), (3.0,), (8.0,), (8.0,), (3.0, 0.3)), 700
    models = [stiff_arm(*own) for own in ratios]
    m, d = mjw.put_model(models[0]), mjw.make_data(models[0], nworld=5)
    d.qpos.assign(np.tile(POSTURE, (5, 1)))
    datas = [mujoco.MjData(model) for model in models]
    for data in datas:
        data.qpos[:] = POSTURE
    here, there = [], []
    with attach_warp(m, d, models[0]) as friction:
        for joint in friction.joints:
            friction.set_parameters(
                joint, [read_friction(model)[joint].parameters for model in models]
            )
        for k in range(steps):
            if k == 350:
                friction.reset(np.array([False, False, False, True, False]))
                datas[3].userdata[:] = 0.0
            d.qfrc_applied.assign(np.tile(held_load(k), (5, 1)))
            mjw.step(m, d)
            here.append(np.hstack([d.qpos.numpy(), d.qvel.numpy()]))
            row = []
            for model, data in zip(models, datas, strict=True):
                with fj.attach(model):
                    data.qfrc_applied[:] = held_load(k)
                    mujoco.mj_step(model, data)
                row.append([*data.qpos, *data.qvel])
            there.append(row)
    return np.array(here), np.array(there)


def test_coupled_stiff_joints_are_held(held):
    here, there = held
    late = slice(600, None)
    rms = np.sqrt(np.mean(here[late, :, 8:] ** 2, axis=(0, 2)))
    # single floats: a torque rounded by EPS moves a joint by h/J times that in a step
    trembles = EPS * 0.5 * FS * STEP / free_inertias().min()
    assert np.all(rms[1:4] < trembles)
    assert np.ptp(here[late, 1:4, :8], axis=0).max() < EPS * POSTURE.max()
    # at h sqrt(K/J) = 1 the arm still swings in, natively too
    quiet = np.sqrt(np.mean(there[late, 0, 8:] ** 2))
    assert rms[0] == pytest.approx(quiet, rel=0.05)


def test_coupled_stiff_joints_move_as_natively(held):
    here, there = held
    moved = np.abs(there - there[0])[:, :, :8]
    assert moved.max() > 1e-3
    # what a float position shows of friction's own, see `warp_kernel`; one joint moves the others
    shown = EPS * POSTURE.max() / 0.01
    assert np.abs(here - there)[:, :, :7].max() < shown
    assert np.abs(here - there)[:, :, 7].max() < 1e-7  # at zero a float is fine, in its own tree


def carrying(one: Effect | None) -> JointFriction:
    """All effects, of which one acts: the others' coefficients are zero."""
    made = (acting(effect) for effect in torques())
    return JointFriction(
        LAW,
        tuple(
            m if m.effect is one else replace(m, coefficients=(0.0,) * len(m.coefficients))
            for m in made
        ),
    )


def two(friction: JointFriction) -> mujoco.MjModel:
    return arm(*friction.effects, law=friction.parameters)


@pytest.fixture(scope="module")
def every_effect():
    """A world an effect, then one without: here, natively, shape (steps, worlds, 4)."""
    which = [*COLUMNS, None]
    each = [carrying(one) for one in which]
    model = two(each[0])
    m, d = mjw.put_model(model), mjw.make_data(model, nworld=len(which))
    here, pushed = [], np.zeros((len(which), 3, 6))
    with attach_warp(m, d, model) as friction:
        friction.set_parameters("a", each)
        for k in range(1000):
            d.ctrl.assign(np.tile(ctrl(k), (len(which), 1)))
            pushed[:, -1, 0] = PUSH * np.sin(0.2 * k)
            d.xfrc_applied.assign(pushed)
            mjw.step(m, d)
            here.append(np.hstack([d.qpos.numpy(), d.qvel.numpy()]))
    there = np.stack([natively(two(one), 1000, PUSH) for one in each], axis=1)
    return dict(zip(which, np.moveaxis(np.array([here, there]), 2, 0), strict=True))


@pytest.mark.parametrize("effect", COLUMNS, ids=name)
def test_every_effect_moves_an_arm_as_natively(every_effect, effect):
    here, there = every_effect[effect]
    assert np.abs(there - every_effect[None][1])[:, :2].max() > 1e-3
    assert np.abs(here - there)[:, :2].max() < 1e-6


def test_parameters_drawn_from_a_posterior_serve_a_world_each():
    spring = next(e for e in COLUMNS if e.name == "spring")
    mean = np.array([0.0, 2.0])

    def made(x):
        law = replace(LAW, Fc_pos=np.exp(x[0]), Fs_pos=1.5 * np.exp(x[0]))
        return JointFriction(law, (SimulatedEffect(spring, (), (x[1], 0.1)),))

    samples = Posterior.of(mean, np.diag([0.01, 0.04]), made).sample(3, seed=1)
    model = two(samples[0])
    m, d = mjw.put_model(model), mjw.make_data(model, nworld=3)
    with attach_warp(m, d, model) as friction:
        friction.set_parameters("a", samples)
        for k in range(300):
            d.ctrl.assign(np.tile(ctrl(k), (3, 1)))
            mjw.step(m, d)
        here = d.qpos.numpy()
        with pytest.raises(ModelError, match="joint 'a' has the effects spring, not none"):
            friction.set_parameters("a", JointFriction(LAW))
        with pytest.raises(ModelError, match="joint 'b' has the effects none, not spring"):
            friction.set_parameters("b", samples)
    there = [natively(two(one), 300)[-1, :2] for one in samples]
    assert np.ptp(there, axis=0)[0] > 1e-3
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-6)


def test_elasticity_backlash_and_late_sensors_are_mujoco_s_own_and_act_here_too():
    spec = mujoco.MjSpec.from_string(ARM)
    elastic = SimulatedEffect(JOINT_ELASTICITY, (12.0, 0.03), (0.03,))
    late = SimulatedEffect(measurement_delay.EFFECT, (0.004,), ())
    gap = SimulatedEffect(BACKLASH, (2e-4, 20.0, 0.1, 0.0), (0.5,))
    fj.install(spec, {"a": LAW, "b": LAW}, {"a": [elastic, late], "b": [gap]})
    model = spec.compile()
    m, d = mjw.put_model(model), mjw.make_data(model, nworld=1)
    data, here, there = mujoco.MjData(model), [], []
    with attach_warp(m, d, model), fj.attach(model):
        for k in range(500):
            data.ctrl[:] = ctrl(k)
            mujoco.mj_step(model, data)
            there.append([*data.qpos, *data.sensordata])
            d.ctrl.assign(ctrl(k)[None])
            mjw.step(m, d)
            here.append([*d.qpos.numpy()[0], *d.sensordata.numpy()[0]])
    here, there = np.array(here), np.array(there)
    position = model.sensor("a_position").adr[0]
    assert np.ptp(there[:, :4], axis=0).min() > 1e-4
    # 4 ms late, and read at the beginning of a step
    np.testing.assert_allclose(there[50:, 4 + position], there[45:-5, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(here[:, :4], there[:, :4], rtol=0, atol=1e-6)
    np.testing.assert_allclose(here[:, 4 + position], there[:, 4 + position], rtol=0, atol=1e-6)


def test_a_captured_graph_steps_as_single_calls_do():
    model = stiff_arm(3.0)
    tracks = []
    for captured in (False, True):
        m, d = mjw.put_model(model), mjw.make_data(model, nworld=2)
        d.qfrc_applied.assign(np.tile(held_load(300), (2, 1)) * [[0.4], [2.5]])
        with attach_warp(m, d, model) as friction:
            mjw.step(m, d)
            graph = None
            if captured:
                kept = [wp.clone(x) for x in (d.time, d.qpos, d.qvel, d.qacc_warmstart)]
                kept.append(wp.clone(friction.state))
                with wp.ScopedCapture(device=d.qpos.device) as capture:
                    mjw.step(m, d)
                graph = capture.graph
                # what a capture itself does to the data differs between devices
                own = (d.time, d.qpos, d.qvel, d.qacc_warmstart, friction.state)
                for array, old in zip(own, kept, strict=True):
                    wp.copy(array, old)
            for _ in range(50):
                wp.capture_launch(graph) if graph else mjw.step(m, d)
            tracks.append(np.hstack([d.qpos.numpy(), d.qvel.numpy(), friction.torque().numpy()]))
    assert np.ptp(tracks[0][:, :8], axis=0).max() > 1e-2
    np.testing.assert_array_equal(*tracks)
