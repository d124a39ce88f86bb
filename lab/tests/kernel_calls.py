"""Every kernel as C beside the Python it is written in, on random numbers.

    FRICTIONJOINT_PYTHON=1 python lab/tests/kernel_calls.py

Laws, effects, controllers and filters run as Python along random motions, and of each kernel some
calls are kept. Hypothesis varies these: every number that is no count, flag or choice moves by a
random factor. The Python and the C function must give the same result, and leave the same arrays.
"""

import dataclasses
import inspect
import math
import pickle
import sys
import traceback
import warnings
from collections import defaultdict
from pathlib import Path

import mujoco
import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests"))
from acting import acting, arm, ctrl

import frictionjoint as fj
from frictionjoint.compiled import native
from frictionjoint.control import kernel as control
from frictionjoint.control.profile import followed
from frictionjoint.control.reconstruct import fill_mean_drives
from frictionjoint.effects.catalogue import CATALOGUE, SIMULATED
from frictionjoint.effects.gear import free_swing
from frictionjoint.effects.kernel import columns, torques
from frictionjoint.effects.signals import DT, GEAR, N_SIGNALS, TIME, A, H, Q, V
from frictionjoint.identify.blocks import gram_matrices
from frictionjoint.identify.rival_shape import gradient
from frictionjoint.identify.smooth import elastic_plastic
from frictionjoint.identify.tracks import fill_grid, path_of
from frictionjoint.law import relaxation, stribeck
from frictionjoint.law.motion import drive_motions, friction_torque
from frictionjoint.law.tangents.along import driven_with_tangents
from frictionjoint.measured.lowpass import LowPass, gentle
from frictionjoint.rivals import (
    ArmstrongParameters,
    DahlParameters,
    DahlStribeckParameters,
    ElastoplasticParameters,
    LuGreParameters,
    MaxwellSlipParameters,
    StaticParameters,
)
from frictionjoint.simulate.one_joint import JointModel, Load, Run, simulate
from frictionjoint.simulate.shaft_wave import resist
from frictionjoint.translate.build import all_kernels

KEPT = 25
EXAMPLES = 12
SAMPLES = 60
# kernels that take addresses of MuJoCo's structures; tests/test_state.py steps them and the same
# functions in Python
ADDRESSED = (
    "frictionjoint.simulate.native.",
    "frictionjoint.simulate.motor.commanded_torque",
)


class Recorder:
    """Keeps arguments of calls, pickled, by kernel while it profiles."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.codes = {k.py_func.__code__: name for name, k in all_kernels().items()}
        self.calls: dict[str, list[bytes]] = defaultdict(list)
        self.seen: dict[str, int] = defaultdict(int)

    def __call__(self, frame, event: str, _: object) -> None:
        """Hook of `sys.setprofile`."""
        name = self.codes.get(frame.f_code)
        if name is None or event != "call":
            return
        self.seen[name] += 1
        count, kept = self.seen[name], self.calls[name]
        if count > KEPT and self.rng.random() > KEPT / count:
            return
        code = frame.f_code
        given = pickle.dumps([frame.f_locals[x] for x in code.co_varnames[: code.co_argcount]])
        if count <= KEPT:
            kept.append(given)
        else:
            kept[int(self.rng.integers(KEPT))] = given


def laws(rng: np.random.Generator) -> list:
    """One of each law with random numbers, the integrated one with several exponents."""
    u = rng.uniform
    levels = {}
    for side in ("pos", "neg"):
        Fc = u(0.5, 1.0)
        levels |= {f"Fs_{side}": Fc * u(1.01, 1.6), f"Fc_{side}": Fc, f"Vs_{side}": u(0.02, 0.2)}
        levels |= {f"delta_{side}": rng.choice([1.0, 2.0, 1.4]), f"sigma2_{side}": u(0.1, 0.5)}
    reach = u(0.5, 2.0)
    knots = ((1e-4 * reach, 0.9), (4e-4 * reach, 1.7), (3e-3 * reach, 3.4))
    own = {"sigma0": u(1e3, 1e4)}
    plain = {k: x for k, x in levels.items() if k[:2] in ("Fc",) or k.startswith("sigma2")}
    integrated = [
        fj.FrictionParameters(
            **levels, knots=knots, sigma1=u(0.0, 2.0), n=n, variant=variant, virgin=virgin
        )
        for n, variant, virgin in (
            (1.0, "ganseman1997", "literal"),
            (2.0, "lampaert2002", "masing"),
            (3.0, "ganseman1997", "masing"),
            (u(1.0, 3.0), "lampaert2002", "literal"),
            (u(3.0, 30.0), "ganseman1997", "literal"),
        )
    ]
    return [
        *integrated,
        StaticParameters(**levels, V0=u(1e-3, 1e-2)),
        ArmstrongParameters(**levels, **own),
        *(DahlParameters(**plain, **own, i=i) for i in (0.0, 1.0, u(0.2, 2.0))),
        DahlStribeckParameters(**levels, **own, i=u(0.5, 2.0)),
        LuGreParameters(**levels, **own, sigma1=u(0.0, 10.0)),
        ElastoplasticParameters(**levels, **own, sigma1=u(0.0, 10.0), breakaway=u(0.3, 0.9)),
        MaxwellSlipParameters(**levels, elements=((5e3, 0.2), (3e3, 0.3), (2e3, 0.5)), C=100.0),
    ]


def motion(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Time and position: presliding, sliding, rest and turns; in the end a loop that closes."""
    t = 1e-3 * np.arange(SAMPLES)
    steps = rng.normal(size=SAMPLES) * 10 ** rng.uniform(-6, -2.5, SAMPLES)
    steps = np.abs(steps) * np.repeat(rng.choice([-1.0, 1.0], SAMPLES // 6), 6)
    steps[rng.random(SAMPLES) < 0.1] = 0.0
    # forth, back, forth by half of it, and back beyond: the inner loop closes from any state
    steps[-18:] = rng.uniform(1e-6, 5e-6) * np.repeat([1.0, -1.0, 1.0, -1.0], (3, 6, 3, 6))
    return t, np.cumsum(steps)


def signals_of(rng: np.random.Generator, t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Signals of a log along a motion; what is not motion is noise."""
    rows = rng.normal(size=(len(t), N_SIGNALS))
    v = np.gradient(q, t)
    rows[:, TIME], rows[:, Q], rows[:, V], rows[:, A] = t, q, v, np.gradient(v, t)
    rows[:, DT] = np.diff(t, prepend=t[0])
    rows[:, H], rows[:, GEAR] = np.tanh(v / 0.01), rng.normal(size=len(t))
    return rows


def along_logs(rng: np.random.Generator) -> None:
    """What fits and filters call."""
    t, q = motion(rng)
    edges = np.array([0, SAMPLES // 2, SAMPLES])
    for law in laws(rng):
        friction_torque(law, t, q)
        P = law.pack()
        H_, rate = np.empty(SAMPLES), np.empty(SAMPLES)
        drive_motions(P, t, q, edges, H_, rate)
        P_t = rng.normal(size=(7, len(P)))
        driven_with_tangents(P, P_t, t, q, edges)
    rows = signals_of(rng, t, q)
    for effect in CATALOGUE:
        shapes = effect.shapes(rows) if effect.shape and effect.shapes else [()]
        shape = shapes[int(rng.integers(len(shapes)))] if shapes else (0.3,) * len(effect.shape)
        if len(shape) == len(effect.shape):
            columns(effect.effect_id, shape, len(effect.coefficients), rows)
            torques(effect.effect_id, shape, rng.normal(size=(2, len(effect.coefficients))), rows)
    free_swing((5.0, 0.1), (0.1, 0.2), rows)
    gradient(q, t, edges)
    elastic_plastic(q, np.array([1e-4, 1e-3]))
    path = path_of(rows, 0.0)
    fill_grid(path.time[None], path.samples, path.averaged, np.empty((1, SAMPLES)))
    gram_matrices(rng.normal(size=(4, SAMPLES)), np.array([0, 2, 3]), edges, np.empty((2, 3, 3)))
    for _ in range(200):
        r, n = rng.uniform(-1.5, 1.5), rng.choice([1.0, 2.0, 3.0, 4.0, rng.uniform(1.0, 9.0)])
        a = 10 ** rng.uniform(-4, 1)
        relaxation.distance(r, relaxation.advance(r, a, n), n)
        stribeck.stribeck_level(np.array([1.5, 1.0, 0.1, n, 0.1]), 0, abs(r))
        # next to the end of the curve, which no number between hits often
        relaxation.advance(1.0 + 1e-5 * r, a, n)


def joints_alone(rng: np.random.Generator) -> None:
    """One joint with its controller, without MuJoCo, free and from a measured motion."""
    t, q = motion(rng)
    fine = np.arange(SAMPLES)
    block = np.zeros(control.BLOCK)
    block[[control.KP, control.KD, control.SUPPLY]] = 50.0, 1.0, 1.0
    block[[control.LIMIT, control.DROP_ERROR, control.DROP_OUTPUT, control.SLEW]] = np.inf
    body = Load(rng.uniform(0.05, 0.2, (10, 1)), 0.01, 0.3, 0.1)
    hot = [e for e in SIMULATED if e.name in ("temperature-dependent", "load-dependent")]
    for law in laws(rng)[::3]:
        model = JointModel(law, [acting(e) for e in hot], 2.0, 0.1, 0.01, 1.5e-3)
        for measured in (None, (q, np.gradient(q, t))):
            run = Run(
                step=1e-3,
                target=q + 0.02 * np.sin(0.3 * fine),
                supply=np.ones(SAMPLES),
                on=rng.random(SAMPLES) < 0.9,
                start=(0.1, 0.0),
                load=body,
                block=block,
                temperature=20.0 + rng.random(SAMPLES),
            )
            simulate(model, run, measured, 20)


def batches(rng: np.random.Generator) -> None:
    """Friction of many joints without MuJoCo, in double and in single precision."""
    _, q = motion(rng)
    for law in laws(rng):
        for kind in (np.float64, np.float32):
            batch = fj.FrictionBatch(law, 2)
            for now, v in zip(q[:15], np.diff(q)[:15] / 1e-3, strict=True):
                batch.step(np.array([now, 2 * now], dtype=kind), np.full(2, v, dtype=kind), 1e-3)


def around(rng: np.random.Generator) -> None:
    """What a question for the torque and the friction of a shaft call."""
    for law in laws(rng):
        model = arm(law=law)
        with fj.attach(model):
            data = mujoco.MjData(model)
            data.ctrl[:] = ctrl(300)
            mujoco.mj_step(model, data, 20)
        fj.torque(model, data)
    spread = rng.uniform(0.5, 2.0, 12)
    spread[3:7] = 0, 0, 1, 1
    resist(spread, 0, rng.normal(size=2), rng.normal(size=2), np.zeros(2))


def controllers(rng: np.random.Generator) -> None:
    """Ticks, profiles and mean drives."""
    t, q = motion(rng)
    blocks = rng.uniform(0.5, 2.0, (2, control.BLOCK))
    blocks[:, control.PERIOD], blocks[:, control.COUNT] = 2e-3, (0.0, 1e-4)
    blocks[:, control.SLEW] = (np.inf, 0.3)
    edges, delays = np.array([0, SAMPLES // 2, SAMPLES]), rng.uniform(0.0, 3e-3, 2)
    v, one, on = np.gradient(q, t), np.ones(SAMPLES), rng.random(SAMPLES) < 0.9
    target = q + 1e-3 * rng.normal(size=SAMPLES)
    path = np.empty((4, 2 * SAMPLES))
    fill_mean_drives(blocks, delays, edges, t, target, q, v, one, on, path, np.empty(SAMPLES))
    for block in blocks:
        memory = np.zeros(control.STATE)
        control.along(block, t, target, q, v, one, np.empty(SAMPLES), memory)
        rate = float(block[control.SLEW])
        followed(t, target, t, min(rate, 1.0))


def simulations(rng: np.random.Generator) -> None:
    """The callback's kernels, by the backend in Python, with every law and effect."""
    some = [acting(effect) for effect in SIMULATED]
    for i, law in enumerate(laws(rng)):
        model = arm(*some[3 * i : 3 * i + 3], law=law)
        with fj.attach(model, "python"):
            data = mujoco.MjData(model)
            for k in range(30):
                data.ctrl[:] = ctrl(20 * k)
                if k == 15 and hasattr(law, "Fs_pos"):
                    less = dataclasses.replace(law, Fs_pos=0.5 * (law.Fs_pos + law.Fc_pos))
                    fj.set_parameters(model, "a", less)
                mujoco.mj_step(model, data)


def filters(rng: np.random.Generator) -> None:
    """A low pass and a derivative."""
    smooth = LowPass(SAMPLES, 1e-3, 50.0, gentle, step=2)
    for derivative in (0, 1):
        smooth(rng.normal(size=(SAMPLES, 2)), derivative)


def varied(value, rng: np.random.Generator, size: float):
    """The same with each number moved by a random factor; whole numbers, infinity and NaN stay."""
    if isinstance(value, tuple):
        parts = [varied(x, rng, size) for x in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        finite = np.isfinite(value)
        moves = finite & (np.where(finite, value, 0.0) % 1.0 != 0.0)
        return np.where(moves, value * np.exp(size * rng.normal(size=value.shape)), value)
    if isinstance(value, float) and math.isfinite(value) and value % 1.0:
        return value * math.exp(size * rng.normal())
    return value


def flat(value) -> np.ndarray:
    """All numbers of a nest of tuples and arrays."""
    if value is None:
        return np.zeros(0)
    if isinstance(value, tuple | list):
        return np.concatenate([np.zeros(0), *map(flat, value)])
    return np.ravel(np.asarray(value, dtype=np.float64))


def compare(python, calls: list[bytes]) -> None:
    """Raise where the C function gives other numbers than the Python one."""
    kernel = native(python)

    @settings(
        max_examples=EXAMPLES, deadline=None, database=None, suppress_health_check=[*HealthCheck]
    )
    @given(
        call=st.sampled_from(calls),
        seed=st.integers(0, 2**32 - 1),
        size=st.sampled_from([0.0, 1e-9, 1e-3, 0.1, 0.5]),
    )
    def same(call: bytes, seed: int, size: float) -> None:
        rng = np.random.default_rng(seed)
        arguments = [varied(x, rng, size) for x in pickle.loads(call)]
        own = pickle.loads(pickle.dumps(arguments))
        try:
            result = python(*own)
        except (ArithmeticError, ValueError, IndexError):
            assume(False)  # what C makes infinity or NaN
        got = kernel(*arguments)
        expected, found = flat((own, result)), flat((arguments, got))
        most = np.max(np.abs(expected), initial=0.0, where=np.isfinite(expected))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * min(1.0, most))

    same()


def main() -> int:
    """Compare all kernels; the number of those that differ or were never called."""
    rng = np.random.default_rng()
    recorder = Recorder(rng)
    sys.setprofile(recorder)
    for part in (along_logs, joints_alone, controllers, simulations, batches, around, filters):
        part(rng)
    sys.setprofile(None)
    wrong = 0
    for name, kernel in all_kernels().items():
        if name.startswith(ADDRESSED):
            continue
        try:
            assert recorder.calls[name], "never called here"
            compare(kernel, recorder.calls[name])
        except Exception:
            wrong += 1
            print(f"{name} {inspect.signature(kernel)}\n{traceback.format_exc()}")
    return wrong


if __name__ == "__main__":
    warnings.simplefilter("ignore", RuntimeWarning)
    sys.exit(min(main(), 1))
