"""`FrictionBatch`: friction for simulators without a passive callback, and its examples."""

import runpy

import mujoco
import numpy as np
import pytest
from test_examples import EXAMPLES, numbers

import frictionjoint as fj
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import FrictionJointError
from frictionjoint.joint_friction import JointFriction, SimulatedEffect

LAW = fj.FrictionParameters.symmetric(
    Fs=1.0, Fc=0.8, Vs=0.1, sigma2=0.05, knots=((5e-4, 1.2), (2e-3, 2.0))
)
WEAK = fj.FrictionParameters.symmetric(
    Fs=0.2, Fc=0.1, Vs=0.1, sigma2=0.05, knots=((5e-4, 0.2), (2e-3, 0.4))
)
INERTIA = 0.01
BIAS = next(e for e in CATALOGUE if e.name == "torque-bias")
WITH_EFFECT = JointFriction(LAW, (SimulatedEffect(BIAS, (), (0.1,)),))


def simulated(h, seconds, torque, kind=np.float64, n=1, laws=LAW, device=None):
    """Positions, shape (steps, n), of n joints under a torque, with semi-implicit Euler."""
    batch = fj.FrictionBatch(laws, n, device=device)
    q, v, positions = np.zeros(n, kind), np.zeros(n, kind), []
    for k in range(round(seconds / h)):
        F, K, D = batch.step(q, v, h)
        other = torque(k * h) - F + D * v
        v = ((INERTIA * v + h * other) / (INERTIA + h * (h * K + D))).astype(kind)
        q = (q + h * v).astype(kind)
        positions.append(q)
    return np.array(positions)


def sine(t):
    return 1.5 * np.sin(2.0 * np.pi * t)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_steps_converge_on_the_motion_that_small_ones_give(kind):
    fine = simulated(5e-5, 1.0, sine)[:, 0]
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        coarse = simulated(h, 1.0, sine, kind)[:, 0]
        every = round(h / 5e-5)
        errors.append(np.abs(coarse - fine[every - 1 :: every]).max())
    assert errors[-1] < 2e-3 * np.ptp(fine)
    assert errors[0] > 1.5 * errors[1] > 2.0 * errors[2]


def test_it_moves_as_muJoCo_with_the_same_friction():
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><option timestep='1e-4' gravity='0 0 0'/><worldbody><body><joint name='j'/>"
        f"<inertial pos='0 0 0' mass='1' diaginertia='{INERTIA} {INERTIA} {INERTIA}'/></body>"
        "</worldbody></mujoco>"
    )
    fj.install(spec, {"j": LAW})
    model = spec.compile()
    data, positions = mujoco.MjData(model), []
    with fj.attach(model):
        for k in range(4_000):
            data.qfrc_applied[0] = sine(1e-4 * k)
            mujoco.mj_step(model, data)
            positions.append(float(data.qpos[0]))
    own = simulated(1e-4, 0.4, sine)[:, 0]
    np.testing.assert_allclose(own, positions, atol=1e-3 * np.ptp(positions))


@pytest.mark.parametrize("kind", [np.float64, np.float32])
@pytest.mark.parametrize("h", [1e-3, 5e-3, 2e-2])
def test_a_joint_rests_under_load_far_from_zero(kind, h):
    """In single precision 3 rad has steps of 2e-7 rad, a fifth of a milli-newton-metre here."""
    batch = fj.FrictionBatch(LAW, 2)
    q, v = np.full(2, 3.0, kind), np.zeros(2, kind)
    places = []
    for k in range(round(8.0 / h)):
        F, K, D = batch.step(q, v, h)
        other = min(1.0, k * h) * np.array([0.4, 0.75]) - F + D * v
        v = ((INERTIA * v + h * other) / (INERTIA + h * (h * K + D))).astype(kind)
        q = (q + h * v).astype(kind)
        places.append(q)
    half, end = places[len(places) // 2], places[-1]
    np.testing.assert_allclose(end, half, atol=1e-6 if kind == np.float32 else 1e-9)
    assert np.all(end - 3.0 < 2e-3)


def test_worlds_and_joints_have_friction_of_their_own_and_are_reset_apart():
    batch = fj.FrictionBatch([LAW, WEAK], (3, 2))
    one, other = fj.FrictionBatch(LAW, 3), fj.FrictionBatch(WEAK, 3)
    q = np.zeros((3, 2))
    for k in range(50):
        v = np.full((3, 2), 0.1 * (k + 1))
        q = q + 1e-3 * v
        both = batch.step(q, v, 1e-3)
        parts = (one.step(q[:, 0], v[:, 0], 1e-3), other.step(q[:, 1], v[:, 1], 1e-3))
    for i in range(3):
        np.testing.assert_array_equal(both[i], np.stack([p[i] for p in parts], axis=1))
    batch.step(np.where(np.eye(3, 2), np.nan, q), v, 1e-3)  # of worlds 0 and 1 a joint each
    assert np.array_equal(np.isnan(batch.step(q, v, 1e-3)[0]), np.eye(3, 2))
    batch.reset(np.array([True, False, False]))
    torque, _, _ = batch.step(q, np.zeros((3, 2)), 1e-3)
    assert np.all(torque[0] == 0.0)
    assert np.all(torque[[1, 2, 2], [0, 0, 1]] > 0.05)


class Tensor:
    """An array of another library that speaks DLPack."""

    def __init__(self, x, device=1):
        self.x, self.device = x, device

    def __dlpack__(self, **kwargs):
        return self.x.__dlpack__(**kwargs)

    def __dlpack_device__(self):
        return self.device, 0


def test_arrays_of_other_libraries_are_read_without_a_copy():
    q, v = np.zeros(3, np.float32), np.full(3, 0.2, np.float32)
    batch, own = fj.FrictionBatch(LAW, 3), fj.FrictionBatch(LAW, 3)
    assert np.shares_memory(batch._array("q", Tensor(q)), q)
    for got, wanted in zip(
        batch.step(Tensor(q), Tensor(v), 1e-3), own.step(q, v, 1e-3), strict=True
    ):
        np.testing.assert_array_equal(got, wanted)
        assert got.dtype == np.float32
    with pytest.raises(FrictionJointError, match=r"device='cuda:0'"):
        batch.step(Tensor(q, 2), v, 1e-3)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_warp_computes_the_same(kind):
    pytest.importorskip("warp", reason="Warp is not installed")
    laws = [LAW, WEAK]
    own = simulated(1e-3, 0.5, sine, kind, 2, laws)
    np.testing.assert_allclose(simulated(1e-3, 0.5, sine, kind, 2, laws, "cpu"), own, atol=1e-7)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"n": 0}, "n is 0"),
        ({"parameters": [LAW, LAW]}, "2 sets of parameters for 3 joints"),
        ({"q": np.zeros(2)}, r"q is of shape \(2,\)"),
        ({"q": np.zeros(3, int)}, "single or double precision"),
        ({"v": np.zeros(3, np.float32)}, "make them one"),
        ({"h": 0.0}, "give a positive number"),
        ({"parameters": WITH_EFFECT}, "effects need a model"),
    ],
)
def test_bad_input_is_one_line(change, what):
    given = {"parameters": LAW, "n": 3, "q": np.zeros(3), "v": np.zeros(3), "h": 1e-3} | change
    with pytest.raises(FrictionJointError, match=what):
        fj.FrictionBatch(given["parameters"], given["n"]).step(given["q"], given["v"], given["h"])


def printed(name, capsys):
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    return capsys.readouterr().out


def test_the_examples_without_mujocos_callback(capsys):
    for line in printed("numpy_pendulum", capsys).splitlines():
        assert float(line.split()[-2]) < 1e-9
        assert abs(float(line.split()[5])) < 0.2
    text = printed("feed_forward", capsys)
    (without,) = numbers("tracking error without feed-forward", text)
    (with_friction,) = numbers("tracking error with feed-forward", text)
    assert with_friction < 0.05 * without
    text = printed("isaac_lab_actuator", capsys)
    assert "the joint stays at 0.00" in text
    assert "the joint goes to 0.29" in text
