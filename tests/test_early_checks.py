"""The gate lets good logs of wrong models pass, and stops logs that no model can be blamed for."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from frictionjoint.effects.signals import LOAD, A
from frictionjoint.errors import LogError
from frictionjoint.identify.early_checks import check, check_signs, scale_is_determined
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.long_logs import shortened
from frictionjoint.measured.readers import read_log
from frictionjoint.simulate.stick_slip import kuka_model
from tests import leg
from tests.three_sines import sines

MODELS = kuka_model().parent
N, DT = 5000, 2e-3
J, MGL = 0.5, 6.0


def pendulum(inertia: float = J, gravity: float = MGL) -> RigidBody:
    """Hangs at zero.

    Args:
        inertia: about the joint, kg m^2. gravity: torque when it is level, N m.
    """
    mass, length = 1.0, 0.0
    if gravity:
        length = 0.5 * inertia * 9.81 / gravity
        mass = gravity / 9.81 / length
    return RigidBody(
        f"""<mujoco><compiler angle="radian"/><worldbody><body><joint name="j" axis="0 1 0"/>
        <inertial mass="{mass}" pos="0 0 {-length}" diaginertia="9 {inertia - mass * length**2} 9"/>
        </body></worldbody></mujoco>""",
        "j",
    )


def motion(speed: float = 1.0, reach: float = 0.6) -> tuple[np.ndarray, ...]:
    """Time, position, velocity and acceleration of three waves."""
    t = DT * np.arange(N)
    lines = [(0.7, 0.25), (0.25, 0.6), (0.05, 1.4)]
    return t, *sines(t, [(reach * size, speed * f) for size, f in lines])


def log(name: str, q: np.ndarray, drive: np.ndarray, noise=0.02, kind="torque") -> JointLog:
    rng = np.random.default_rng(2)
    drive = drive + noise * rng.standard_normal(N)
    return JointLog(name=name, joint="j", time=DT * np.arange(N), position=q, **{kind: drive})


def stages(q: np.ndarray, level: float, reach: float) -> np.ndarray:
    """Torque of one elastic-plastic element, written again."""
    out, now = np.zeros(len(q)), 0.0
    for i in range(1, len(q)):
        now = max(-level, min(level, now + level / reach * (q[i] - q[i - 1])))
        out[i] = now
    return out


@cache
def good_logs() -> dict[str, JointLog]:
    t, q, v, a = motion()
    load = J * a + MGL * np.sin(q)
    coulomb = 1.5 * np.tanh(v / 0.01)
    _, small, _, gentle = motion(0.3, 2e-3)
    _, _, rapid, hard = motion(2.0, 0.6)
    fast = motion(2.0, 0.6)[1]
    late, way = int(8e-3 / DT), 0.3 * t + 0.15 * np.sin(1.3 * t)
    sensed = J * hard + MGL * np.sin(fast)
    return {
        "coulomb": log("coulomb", q, load + coulomb + 0.4 * v),
        "viscous alone": log("viscous", q, load + 2.0 * v),
        "hardly any friction": log("free", q, load + 0.02 * np.tanh(v / 0.01)),
        "biased": log("biased", q, load + coulomb + 3.0),
        "spring": log("spring", q, load + coulomb + 8.0 * q),
        "cogging": log("cogging", q, load + coulomb + 2.0 * np.sin(40 * q)),
        "presliding alone": log(
            "presliding", small, J * gentle + MGL * np.sin(small) + stages(small, 1.5, 4e-3), 5e-4
        ),
        "a torque sensor, read 8 ms late": log("late", fast, np.roll(sensed, late) + 0.1 * rapid),
        "at rest half the time": log(
            "rests", np.where(t < 5.0, q, q[2500]), np.where(t < 5.0, load + coulomb, load[2500])
        ),
        "one way": log("one way", 0.5 * t, MGL * np.sin(0.5 * t) + 1.5 + 0.4 * np.sin(7 * t)),
        "one way, gravity of another joint": log("other", way, MGL * np.sin(1.5 * way) + 1.5),
        "a current": log("current", q, (load + coulomb) / 3.7, 0.005, kind="current"),
        "a voltage": log("voltage", q, (load + coulomb) / 0.2 + 9.0 * v, 0.05, kind="voltage"),
    }


@pytest.mark.parametrize("kind", good_logs())
def test_good_logs_pass(kind: str) -> None:
    check(prepare([good_logs()[kind]], pendulum()))


@pytest.mark.parametrize("kind", ["coulomb", "viscous alone", "biased", "a current", "a voltage"])
def test_wrong_signs_are_named(kind: str) -> None:
    good = good_logs()[kind]
    drive = next(n for n in ("torque", "voltage", "current") if getattr(good, n) is not None)
    for name in ("position", drive):
        wrong = replace(good, **{name: -getattr(good, name)})
        with pytest.raises(LogError, match=f"wrong sign of position or {drive}"):
            check(prepare([wrong], pendulum()))


def test_a_log_that_something_pushes_is_not_refused_beside_others() -> None:
    """Its own balance has a friction that drives, but not the sign that the others would have."""
    _, q, v, a = motion()
    pushed = log("pushed", q, J * a + MGL * np.sin(q) - 3.0 * v)
    with pytest.raises(LogError, match="wrong sign"):
        check(prepare([pushed], pendulum()))
    _, q, v, a = motion(0.7)
    good = log("good", q, J * a + MGL * np.sin(q) + 0.4 * np.tanh(v / 0.01) + 0.8 * v)
    check(prepare([good, pushed], pendulum()))
    turned = replace(good_logs()["coulomb"], torque=-good_logs()["coulomb"].torque)
    with pytest.raises(LogError, match="coulomb: wrong sign"):
        check(prepare([good, turned], pendulum()))


def test_where_no_torque_was_measured_the_target_is_named() -> None:
    body, good = RigidBody(leg.MODEL, "j"), leg.leg(leg.BELIEVED)
    check(prepare([good], body, controller=leg.CONTROLLER))
    wrong = replace(good, position=-good.position)
    with pytest.raises(LogError, match=r"position or target: .* of position_rad and target_rad, "):
        check(prepare([wrong], body, controller=leg.CONTROLLER))


@pytest.mark.parametrize("kind", ["torque", "current"])
def test_noise_is_no_torque(kind: str) -> None:
    _, q, _, _ = motion()
    for seed in range(3):
        white = np.random.default_rng(seed).standard_normal(N)
        for x in (white, gaussian_filter1d(white, 0.05 / DT)):
            with pytest.raises(LogError, match="the residual is"):
                check(prepare([log("noise", q, x, 0.0, kind=kind)], pendulum()))


def altered(prepared: Prepared, inertia: float, load: float) -> Prepared:
    """The same logs of a model whose inertia, or whole load, is another."""
    segments = []
    for s in prepared.segments:
        x = s.signals.copy()
        a = x[:, A]
        own = float(a @ x[:, LOAD] / (a @ a))
        x[:, LOAD] = load * (x[:, LOAD] + (inertia - 1.0) * max(own, 0.0) * a)
        segments.append(replace(s, signals=x))
    return replace(prepared, segments=tuple(segments))


REAL = [
    *(("panda", f"joint{i}", "panda.xml") for i in range(1, 8)),
    *(("unisa_ur10/ur10.csv", f"j{i}", "ur10.xml") for i in range(1, 7)),
    *(("staubli_tx40", f"joint_{i}", "staubli_tx40.xml") for i in range(1, 7)),
    *(("kuka_kr300/A.csv", f"axis{i}", "kuka_kr300.xml") for i in range(1, 4)),
    ("emps/DATA_EMPS.mat", "carriage", "emps.xml"),
    ("odrive_cogging/slow2__nocomp_0.npy", "rotor", "bldc_motor.xml"),
    ("odrive_cogging/slow2__comp_0.npy", "rotor", "bldc_motor.xml"),
    ("xl330/2026-01-15_10h28m57.json", "pendulum", "xl330_pendulum.xml"),
    ("xl330/2026-01-15_10h29m04.json", "pendulum", "xl330_pendulum.xml"),
]


@pytest.mark.parametrize(("path", "joint", "model"), REAL)
def test_measured_logs_pass_whatever_the_model_lacks(
    measured_data: Path, path: str, joint: str, model: str
) -> None:
    body = RigidBody(MODELS / model, joint)
    prepared = prepare(shortened([read_log(measured_data / path, joint)]), body)
    check(prepared)
    for inertia, load in ((0.5, 1.0), (1.5, 1.0), (1.0, 0.7), (1.0, 1.3)):
        check(altered(prepared, inertia, load))


def quick_fit(one: JointLog, body: RigidBody) -> tuple[Prepared, Fit]:
    """A fit from one start, which is near enough for what is asked of it here."""
    prepared = prepare([one], body)
    return prepared, refit(prepared, (), replace(INTEGRATED[0], Vs=0.05, length=1e-3))


def test_the_load_determines_the_scale_of_a_current_or_it_is_said() -> None:
    body = pendulum()
    prepared, fitted = quick_fit(good_logs()["a current"], body)
    assert scale_is_determined(prepared, fitted)
    assert fitted.gain == pytest.approx(3.7, rel=0.1)
    # no gravity, slow, and cogging that no model has: the inertia is lost in it
    _, q, v, a = motion(0.2)
    lost = 0.05 * a + 1.5 * np.tanh(v / 0.01) + 0.5 * np.sin(25 * q)
    free = pendulum(0.05, 0.0)
    prepared, fitted = quick_fit(log("lost", q, lost / 3.7, 0.005, kind="current"), free)
    assert not scale_is_determined(prepared, fitted)
    prepared, fitted = quick_fit(log("known", q, lost), free)
    assert scale_is_determined(prepared, fitted)


def test_a_voltage_of_one_magnitude_determines_nothing() -> None:
    t = 0.01 * np.arange(2000)
    speed = 20.0 * np.sign(np.sin(0.5 * t)) * (1.0 - 0.5 * np.exp(-((t % 6.28) / 0.3)))
    step = JointLog(
        name="step",
        joint="j",
        time=t,
        position=np.cumsum(speed) * 0.01,
        voltage=12.0 * np.sign(speed),
    )
    with pytest.raises(LogError, match="same magnitude, 12, throughout"):
        check_signs(prepare([step], pendulum(1e-3, 0.0)))
    there_and_back = replace(step, voltage=12.0 * np.sign(np.sin(0.5 * t + 0.8)))
    check_signs(prepare([there_and_back], pendulum(1e-3, 0.0)))
