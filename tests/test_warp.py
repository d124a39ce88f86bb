"""Friction in mujoco_warp: the same law as the native callback, in many worlds at once."""

import sys

import mujoco
import numpy as np
import pytest
from acting import ARM, LEVELS, RIVALS, acting

import frictionjoint as fj
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ModelError
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.law.memory import N_MAX, N_MIN
from frictionjoint.simulate.block import ROW
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.joint_effects import effects_torque
from frictionjoint.simulate.row import FRONT, rare_torque, row_size
from tests.standing import one_joint

mjw = pytest.importorskip("mujoco_warp")
wp = pytest.importorskip("warp")

from frictionjoint.simulate import warp_kernel  # noqa: E402
from frictionjoint.simulate.warp import WarpMissingError, attach_warp  # noqa: E402
from frictionjoint.translate.warp import translate  # noqa: E402

STIFF = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))
SOFT = ((5e-3, 1.5), (15e-3, 2.5), (50e-3, 3.2))
INERTIA, STEP = 0.01, 1e-3
EPS = 2.0**-24  # half a unit in the last place of a single float, relative


def friction(**changes) -> fj.FrictionParameters:
    values = LEVELS | {"sigma1": 0.5, "n": 2, "knots": SOFT}
    return fj.FrictionParameters.symmetric(**(values | changes))


def arm(integrator="implicitfast", **of_a) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(ARM.replace("implicitfast", integrator))
    fj.install(spec, {"a": friction(**of_a), "b": friction()})
    return spec.compile()


def load(t: float, world: int = 0) -> list[float]:
    """Slow and fast sines: presliding loops nest, and now and then a joint breaks away."""
    slow = (2.2 + 0.1 * world) * np.sin(9 * t) + 0.8 * np.sin(41 * t)
    return [slow, 0.9 * np.sin((23 + world) * t)]


def worlds(mjm: mujoco.MjModel, n: int):
    return mjw.put_model(mjm), mjw.make_data(mjm, nworld=n)


def step(m, d, loads) -> np.ndarray:
    """A step under loads of shape (nworld, nv): positions and velocities, (nworld, 2 nv)."""
    d.qfrc_applied.assign(np.asarray(loads, dtype=np.float32))
    mjw.step(m, d)
    return np.hstack([d.qpos.numpy(), d.qvel.numpy()])


def run(mjm, steps, which=(0,)) -> np.ndarray:
    """Worlds under their loads: positions and velocities, shape (steps, worlds, 2 nv)."""
    m, d = worlds(mjm, len(which))
    out = []
    with attach_warp(m, d, mjm):
        for k in range(steps):
            out.append(step(m, d, [load(1e-3 * k, w) for w in which]))
    return np.array(out)


def native(mjm, steps) -> np.ndarray:
    """World 0 by the native callback, shape (steps, 2 nv)."""
    data = mujoco.MjData(mjm)
    out = []
    with fj.attach(mjm):
        for k in range(steps):
            data.qfrc_applied[:] = np.float32(load(1e-3 * k))
            mujoco.mj_step(mjm, data)
            out.append([*data.qpos, *data.qvel])
    return np.array(out)


# the law


@pytest.fixture(scope="module")
def in_warp():
    """Runs warp's `rare_torque` along motions q and v, shape (worlds, n)."""
    size = 128
    made = translate([rare_torque], size, "frictionjoint_test")["simulate_row_rare_torque"]
    vector, matrix = wp.array(dtype=wp.float64), wp.array2d(dtype=wp.float64)

    @wp.kernel(enable_backward=False, module="unique")
    def kernel(
        P: vector,
        X: matrix,
        t: vector,
        q: matrix,
        v: matrix,
        h: wp.float64,
        inertia: wp.float64,
        effects: int,
        out: matrix,
    ):
        w = wp.tid()
        for k in range(t.shape[0]):
            weight = wp.float64(1.0) / inertia
            out[w, k] = made(P, 0, effects, X[w], 0, t[k], q[w, k], v[w, k], h, h, inertia, weight)

    def torque(P, t, q, v, h, inertia):
        X = wp.zeros((len(q), size), dtype=wp.float64, device="cpu")
        out = wp.zeros(q.shape, dtype=wp.float64, device="cpu")
        arrays = [wp.array(a, dtype=wp.float64, device="cpu") for a in (t, q, v)]
        numbers = wp.array(P, dtype=wp.float64, device="cpu")
        inputs = [numbers, X, *arrays, wp.float64(h), wp.float64(inertia), len(P) - 1]
        wp.launch(kernel, dim=len(q), inputs=inputs, outputs=[out], device="cpu")
        return out.numpy()

    return torque


def in_c(P, t, q, v, h, inertia):
    out = np.zeros_like(q)
    for w in range(len(q)):
        X = np.zeros(row_size(int(law_row_size(P, 0)), 0))
        for k in range(len(t)):
            motion = t[k], q[w, k], v[w, k]
            out[w, k] = rare_torque(P, 0, len(P) - 1, X, 0, *motion, h, h, inertia, 1.0 / inertia)
    return out


INTEGRATED = [
    friction(n=n, knots=STIFF, variant=variant, virgin=virgin)
    for n in (1.0, 1.5, 2.0, 3.0, 4.0, 7.3)
    for variant, virgin in (("ganseman1997", "literal"), ("lampaert2002", "masing"))
]


@pytest.mark.parametrize("h", [0.0, 1e-3], ids=["explicit", "stiff"])
@pytest.mark.parametrize("parameters", INTEGRATED + RIVALS, ids=lambda p: f"{p.law}")
def test_warp_computes_what_the_library_computes(in_warp, parameters, h):
    rng = np.random.default_rng(1)
    n = 400
    t = 1e-3 * np.arange(n)
    size = np.array([1e-7, 1e-6, 1e-5, 1e-4])[:, None]
    q = np.cumsum(size * rng.normal(size=(4, n)), axis=1) + 20 * size * np.sin(30 * t)
    v = np.gradient(q, t, axis=1)
    P = np.append(parameters.pack(), 0.0)
    expected = in_c(P, t, q, v, h, 1e-3)
    # the same operations in doubles: only the mathematical libraries differ in the last digit
    np.testing.assert_allclose(in_warp(P, t, q, v, h, 1e-3), expected, rtol=0, atol=1e-11)


def test_warp_computes_every_effect_as_the_library_does():
    rng = np.random.default_rng(2)
    law = friction().pack()
    carried = [acting(e) for e in CATALOGUE]
    P = np.concatenate([law, [float(len(carried))], *(e.pack() for e in carried)])
    size = row_size(int(law_row_size(P, 0)), len(carried))
    name, made = "simulate_joint_effects_effects_torque", [rare_torque, effects_torque]
    namespace = translate(made, size, "frictionjoint_test_effects")
    joint, effect = namespace["simulate_row_rare_torque"], namespace[name]
    vector = wp.array(dtype=wp.float64)

    @wp.kernel(enable_backward=False, module="unique")
    def kernel(P: vector, X: vector, t: vector, u: wp.array2d(dtype=wp.float64), e: int, y: vector):
        for k in range(t.shape[0]):
            # velocity, bias, inertia, armature, unit gravity torques, torque asked for
            long, h, v = wp.float64(1.0), wp.float64(0.0), u[k, 1]
            joint(P, 0, e, X, 0, t[k], u[k, 0], v, long, h, u[k, 3], h)
            J, rotor, asked = u[k, 3], u[k, 4], u[k, 7]
            y[k] = effect(
                P, 0, e, X, 0, t[k], u[k, 0], v, u[k, 2], J, rotor, u[k, 5], u[k, 6], asked
            )

    n, e = 300, len(law)
    t = 1e-3 * np.arange(n)
    q = 0.5 * np.sin(20 * t) + 1e-3 * rng.normal(size=n)
    rigid = [1 + np.sin(9 * t), np.full(n, 0.1), np.full(n, 0.05)]
    u = np.column_stack([q, np.gradient(q, t), *rigid, q, 1 - q, 3 * q])
    X, expected = np.zeros(size), np.zeros(n)
    for k in range(n):
        rare_torque(P, 0, e, X, 0, t[k], u[k, 0], u[k, 1], 1.0, 0.0, u[k, 3], 0.0)
        expected[k] = effects_torque(P, 0, e, X, 0, t[k], u[k, 0], u[k, 1], *u[k, 2:])
    y = wp.zeros(n, dtype=wp.float64, device="cpu")
    arrays = [wp.array(a, dtype=wp.float64, device="cpu") for a in (P, np.zeros(size), t, u)]
    wp.launch(kernel, dim=1, inputs=[*arrays, e], outputs=[y], device="cpu")
    assert np.ptp(expected) > 1.0
    np.testing.assert_allclose(y.numpy(), expected, rtol=1e-12, atol=1e-11)


# against the native callback


def test_presliding_loops_remember_the_same_extrema():
    mjm = arm()
    at = resolve(mjm)
    m, d = worlds(mjm, 1)
    data = mujoco.MjData(mjm)
    deepest = 0
    with fj.attach(mjm), attach_warp(m, d, mjm) as friction:
        first = friction.joint_rows["a"] + warp_kernel.FRONT + FRONT
        row = int(mjm.numeric_data[at["a"] + ROW]) + FRONT
        for k in range(700):
            t = 1e-3 * k
            shrinking = [1.2 * np.exp(-2 * t) * np.sin(55 * t), 0.0]
            data.qfrc_applied[:] = np.float32(shrinking)
            mujoco.mj_step(mjm, data)
            got = step(m, d, [shrinking])[0]
            X = friction.state.numpy()[0]
            count = slice(row + N_MIN, row + N_MAX + 1)
            np.testing.assert_array_equal(
                X[first + N_MIN : first + N_MAX + 1], data.userdata[count]
            )
            deepest = max(deepest, int(data.userdata[count].sum()) - 2)
            np.testing.assert_allclose(got, [*data.qpos, *data.qvel], rtol=0, atol=1e-6)
    assert deepest >= 6


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast"])
def test_an_arm_moves_as_with_the_native_callback(integrator):
    mjm = arm(integrator)
    there = native(mjm, 400)
    here = run(mjm, 400)[:, 0]
    assert np.abs(there[:, 2:]).max() > 0.5
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-5)


def hinge(ratio: float, **changes) -> mujoco.MjModel:
    """One hinge whose h sqrt(K/J) is `ratio`."""
    K = INERTIA * (ratio / STEP) ** 2
    spec = mujoco.MjSpec.from_string(one_joint(INERTIA, STEP))
    knots = ((1.5 / K, 1.5), (6.0 / K, 3.0))
    law = friction(**({"n": 4.0, "virgin": "masing", "sigma1": 0.0, "knots": knots} | changes))
    fj.install(spec, {"j": law})
    return spec.compile()


def held(mjm: mujoco.MjModel, start: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Half of the breakaway torque put on and held: q and v natively and here, (steps, 2) each."""
    m, d = worlds(mjm, 1)
    data = mujoco.MjData(mjm)
    data.qpos[:] = start
    d.qpos.fill_(start)
    there, here = [], []
    with fj.attach(mjm), attach_warp(m, d, mjm):
        for k in range(steps):
            torque = np.float32(0.75 * min(1.0, k / 300))
            data.qfrc_applied[:] = torque
            mujoco.mj_step(mjm, data)
            there.append([data.qpos[0], data.qvel[0]])
            here.append(step(m, d, [[torque]])[0])
    return np.array(there), np.array(here)


@pytest.mark.parametrize("damping_ratio", [2.5, 25.0])
def test_viscous_friction_beyond_the_explicit_limit_only_brakes(damping_ratio):
    sigma2 = damping_ratio * INERTIA / STEP
    mjm = hinge(0.1, Fs=1e-6, Fc=1e-6, sigma2=sigma2)
    m, d = worlds(mjm, 1)
    d.qvel.fill_(1.0)
    with attach_warp(m, d, mjm):
        speeds = [step(m, d, [[0.0]])[0, 1] for _ in range(30)]
    # at most as fast as the presliding spring lets it return
    assert min(speeds) > -1.01 * 1e-6 / sigma2
    data = mujoco.MjData(mjm)
    data.qvel[:] = 1.0
    with fj.attach(mjm):
        mujoco.mj_step(mjm, data)
    assert speeds[0] == pytest.approx(data.qvel[0], rel=1e-5)
    assert 0.0 < speeds[0] < 1.0 / (1.0 + damping_ratio)
    assert abs(speeds[-1]) < 1e-4


def test_a_joint_far_from_zero_is_held_as_quietly_as_at_zero():
    """A float at 3 rad is off by 1.2e-7 rad; taken at its word, friction jumps by K times that."""
    mjm = hinge(0.4)
    there, here = held(mjm, 3.0, 900)
    quiet = np.sqrt(np.mean(there[700:, 1] ** 2))
    jump = INERTIA * (0.4 / STEP) ** 2 * EPS * 2.0
    assert quiet < 0.1 * jump * STEP / INERTIA
    assert np.sqrt(np.mean(here[700:, 1] ** 2)) < 0.1 * jump * STEP / INERTIA
    # a step takes a hundredth of the distance from the position shown, see `warp_kernel`
    assert np.abs(here[:, 0] - there[:, 0]).max() < EPS * 3.0 / 0.01


# many worlds, and the rule that commits


def test_worlds_do_not_touch_each_other():
    mjm = arm()
    which = (0, 3, 1, 7, 5)
    together = run(mjm, 150, which)
    for i, world in enumerate(which):
        np.testing.assert_array_equal(together[:, i], run(mjm, 150, (world,))[:, 0])


@pytest.mark.parametrize("kind", ["numpy", "warp"])
def test_one_world_forgets_and_the_others_do_not(kind):
    mjm = arm()
    m, d = worlds(mjm, 3)
    mask = np.array([False, True, False])
    with attach_warp(m, d, mjm) as friction:
        for k in range(100):
            step(m, d, [load(1e-3 * k, w) for w in range(3)])
        mjw.forward(m, d)
        before = friction.torque().numpy().copy()
        friction.reset(wp.array(mask, dtype=wp.bool) if kind == "warp" else mask)
        mjw.forward(m, d)
        after = friction.torque().numpy().copy()
    fresh_m, fresh = worlds(mjm, 3)
    for name in ("qpos", "qvel", "qfrc_applied", "qacc_warmstart"):
        getattr(fresh, name).assign(getattr(d, name))
    with attach_warp(fresh_m, fresh, mjm) as friction:
        mjw.forward(fresh_m, fresh)
        never_moved = friction.torque().numpy()
    np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
    np.testing.assert_allclose(after[1], never_moved[1], rtol=1e-5)
    assert np.all(np.abs(before - never_moved) > 1e-2)


def test_every_world_may_have_its_own_parameters():
    mjm = arm()
    m, d = worlds(mjm, 3)
    changes = {}, {"Fs": 0.8, "Fc": 0.6}, {"sigma2": 2.0}
    own = [friction(**each) for each in changes]
    with attach_warp(m, d, mjm) as acting:
        acting.set_parameters("a", own)
        track = [step(m, d, [load(1e-3 * k)] * 3) for k in range(200)]
        for world, each in enumerate(changes):
            alone = run(arm(**each), 200)[:, 0]
            np.testing.assert_array_equal(np.array(track)[:, world], alone)
        acting.set_parameters("a", own[1])
        assert np.ptp(acting.parameters.numpy(), axis=0).max() == 0.0


def test_a_world_gone_astray_neither_hangs_nor_spreads():
    mjm = arm()
    m, d = worlds(mjm, 3)
    with attach_warp(m, d, mjm) as friction:
        for k in range(60):
            if k == 20:
                d.qpos.assign(np.vstack([[np.nan, 0.0], d.qpos.numpy()[1:]]))
                d.qvel.assign(np.vstack([d.qvel.numpy()[:2], [0.0, np.inf]]))
            got = step(m, d, [load(1e-3 * k)] * 3)
        assert np.isnan(friction.torque().numpy()[[0, 2], [0, 1]]).all()
        np.testing.assert_array_equal(got[1], run(mjm, 60)[-1, 0])
        good = step(m, d, [load(0.06)] * 3)[1]
        d.qpos.assign(np.tile(good[:2], (3, 1)))
        d.qvel.assign(np.tile(good[2:], (3, 1)))
        mjw.forward(m, d)
        assert np.isfinite(friction.torque().numpy()).all()
        mjw.reset_data(m, d)
        again = [step(m, d, [load(1e-3 * k)] * 3) for k in range(20)]
    np.testing.assert_array_equal(np.array(again)[:, 0], run(mjm, 20)[:, 0])


# refusals


def test_runge_kutta_and_disabled_passive_forces_are_refused():
    mjm = arm("RK4")
    with pytest.raises(ModelError, match=r"does not support the integrator RK4: use EULER"):
        attach_warp(*worlds(mjm, 1), mjm)
    mjm = arm()
    mjm.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_SPRING
    mjm.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_DAMPER
    with pytest.raises(ModelError, match="calls no passive force"):
        attach_warp(*worlds(mjm, 1), mjm)


def test_parameters_that_do_not_fit_are_refused():
    mjm = arm()
    m, d = worlds(mjm, 2)
    with attach_warp(m, d, mjm) as acting:
        with pytest.raises(ModelError, match="joint 'c' has no friction: choose from a, b"):
            acting.set_parameters("c", friction())
        with pytest.raises(ModelError, match="2 worlds, 3 parameter sets"):
            acting.set_parameters("a", [friction()] * 3)
        with pytest.raises(ModelError, match="keep law and number of knots"):
            acting.set_parameters("a", RIVALS[0])


def test_without_mujoco_warp_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco_warp", None)
    with pytest.raises(WarpMissingError, match=r"pip install 'frictionjoint\[warp\]'"):
        attach_warp(None, None, arm())
