"""One joint in closed loop, without MuJoCo: its law, its effects, its load and its controller.

It steps as MuJoCo does with implicitfast, with the kernels of the callback, about fifty times
faster. Other joints follow their measured motion. Limits and contacts are left out.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, in_line, room
from frictionjoint.control.kernel import STATE, tick
from frictionjoint.effects.kernel import MEMORY
from frictionjoint.effects.signals import TEMP
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.parameters import Friction
from frictionjoint.simulate.joint_effects import effects_torque
from frictionjoint.simulate.row import FRONT, GAIN, TORQUE, rare_torque, row_size, torque_now

# rows of `Load.numbers`; mean, cosine and sine of each unit torque
INERTIA, COS, SIN, REST, GX = range(5)
GY = GX + 3
ROWS = GY + 3


@dataclass(frozen=True)
class Load:
    """Rigid-body torque: inertia a + c cos q + s sin q + r + stiffness (q - q0).

    Attributes:
        numbers: inertia, c, s, r, and the mean, cosine and sine of the two unit gravity torques,
            shape (10, n); n is 1 if they are constant.
        armature: kg m^2, part of the inertia. stiffness, rest: of the MJCF's own spring, and q0.
    """

    numbers: Array
    armature: float
    stiffness: float
    rest: float


class JointModel:
    """A joint for simulation, without its load and its controller.

    Args:
        gain: N m per unit of the drive. back_emf: N m s/rad, while the drive is on.
        inertia: kg m^2 in addition to the MJCF's. lag: s from a tick to its torque.
    Attributes:
        numbers: block of the law, then of the effects. effects: where those begin. row: number of
            float64 of state.
        thermal: place in the row and reference, deg C, of each effect's temperature, shape (k, 2).
    """

    def __init__(
        self,
        law: Friction,
        effects: list[SimulatedEffect],
        gain: float,
        back_emf: float = 0.0,
        inertia: float = 0.0,
        lag: float = 0.0,
    ) -> None:
        packed = law.pack()
        self.numbers = np.concatenate([packed, [float(len(effects))], *(e.pack() for e in effects)])
        self.effects = len(packed)
        self.gain, self.back_emf, self.inertia, self.lag = gain, back_emf, inertia, lag
        law_row = int(law_row_size(self.numbers, 0))
        self.row = row_size(law_row, len(effects))
        thermal = [
            (float(FRONT + law_row + MEMORY * i), e.shape[0])
            for i, e in enumerate(effects)
            if TEMP in e.effect.needs
        ]
        self.thermal = np.array(thermal).reshape(-1, 2)


@dataclass(frozen=True)
class Run:
    """Input of a simulation, on its own time steps, arrays of shape (n,).

    Attributes:
        step: s. target: as received by the controller, rad.
        supply: supply voltage relative to that of the block.
        on: whether the drive is on. start: position and velocity at the first step.
        temperature: as measured, deg C; None: effects are at their reference temperatures.
    """

    step: float
    target: Array
    supply: Array
    on: NDArray[np.bool_]
    start: tuple[float, float]
    load: Load
    block: Array
    temperature: Array | None = None


def simulate(
    model: JointModel,
    run: Run,
    motion: tuple[Array, Array] | None = None,
    window: int | None = None,
) -> Array:
    """Position at every step, rad, shape (n,).

    Friction holds a joint that is at rest at first, as far as it can, against its load, its effects
    and its drive, which is assumed to have acted before; otherwise it starts as if never moved.

    Args:
        motion: measured position and velocity on the steps, shape (n,) each, from which the run is
            restarted after every `window` steps; friction and controller follow that motion up to
            there. None: the whole run is free.
    """
    n = len(run.target)
    q, v = motion if motion is not None else (np.zeros(0), np.zeros(0))
    given = _Given(
        P=model.numbers,
        effects=model.effects,
        B=run.block,
        motor=np.array([model.gain, model.back_emf, model.inertia, model.lag / run.step]),
        load=np.ascontiguousarray(run.load.numbers),
        body=np.array([run.load.armature, run.load.stiffness, run.load.rest]),
        step=run.step,
        target=run.target,
        supply=run.supply,
        on=run.on,
        q=q,
        v=v,
        temperature=np.zeros(0) if run.temperature is None else run.temperature,
        thermal=model.thermal if run.temperature is not None else model.thermal[:0],
        began=False,
    )
    X, S, position, drive = np.zeros(model.row), np.zeros(STATE), np.empty(n), np.empty(n)
    if run.start[1] == 0.0 and not _hold(given, X, run.start[0]):
        given = given._replace(began=True)
    if motion is None:
        _part(given, X, S, run.start[0], run.start[1], 0, n, position, drive)
    else:
        _windows(given, X, S, window or n, position, drive)
    return position


class _Given(NamedTuple):
    """Constants of a run; for those not named here see `JointModel`, `Run` and `Load`.

    Attributes:
        P: numbers of the model. B: block of the controller.
        motor: gain, back-EMF, inertia and lag, in steps. body: armature, stiffness and rest.
        q, v: measured motion, shape (n,), or (0,) without. temperature, thermal: empty without.
        began: whether the drive starts at the first step; then a lag finds no earlier drive.
    """

    P: Array
    effects: int
    B: Array
    motor: Array
    load: Array
    body: Array
    step: float
    target: Array
    supply: Array
    on: NDArray[np.bool_]
    q: Array
    v: Array
    temperature: Array
    thermal: Array
    began: bool


@in_line
def _load_torque(load: Array, body: Array, i: int, q: float, c: float, s: float) -> float:
    """Torque of the rigid body and of the MJCF's spring at step i; c, s: cosine, sine of q."""
    return float(load[COS, i] * c + load[SIN, i] * s + load[REST, i] + body[1] * (q - body[2]))


@in_line
def _effects(
    given: _Given,
    X: Vector,
    k: int,
    t: float,
    q: float,
    v: float,
    bias: float,
    c: float,
    s: float,
    asked: float,
) -> float:
    """Torque of the effects at step k, with their signals; c, s: cosine and sine of q."""
    load, body = given.load, given.body
    i = min(k, load.shape[1] - 1)
    gx = load[GX, i] + load[GX + 1, i] * c + load[GX + 2, i] * s
    gy = load[GY, i] + load[GY + 1, i] * c + load[GY + 2, i] * s
    behind = load[INERTIA, i] - body[0]
    for j in range(len(given.thermal)):  # the measured temperature, into the effects' memory
        X[int(given.thermal[j, 0])] = given.temperature[k] - given.thermal[j, 1]
    return effects_torque(
        given.P, 0, given.effects, X, 0, t, q, v, bias, behind, body[0], gx, gy, asked
    )


@compiled
def _hold(given: _Given, X: Vector, q: float) -> bool:
    """Deflect the friction of a joint at rest to balance drive and load; whether it can."""
    asked = 0.0
    if given.on[0]:
        S = room(STATE)
        asked = given.motor[0] * tick(given.B, S, 0.0, given.target[0], q, 0.0, given.supply[0])
    tried = room(len(X))
    way = -math.copysign(1.0, _tried(given, X, tried, q, 0.0, asked))
    # displacements, rad (m), from 1e-9 to 1; the range is then halved 40 times
    least, most = 0.0, 1e-9
    while _tried(given, X, tried, q, way * most, asked) * way < 0.0:
        least, most = most, 2.0 * most
        if most > 1.0:
            return False
    for _ in range(40):
        middle = 0.5 * (least + most)
        if _tried(given, X, tried, q, way * middle, asked) * way < 0.0:
            least = middle
        else:
            most = middle
    _unbalanced(given, X, q, way * least, asked)
    return True


@compiled
def copy(X: Vector, to: Vector) -> None:
    """Fill `to` with the numbers of X."""
    for i in range(len(X)):
        to[i] = X[i]


@compiled
def _tried(given: _Given, X: Vector, tried: Vector, q: float, d: float, asked: float) -> float:
    """Result of `_unbalanced` for a row that starts as a copy of X."""
    copy(X, tried)
    return _unbalanced(given, tried, q, d, asked)


@compiled
def _unbalanced(given: _Given, X: Vector, q: float, d: float, asked: float) -> float:
    """Torque minus drive, at rest at q after a slow displacement d from a relaxed contact."""
    P, effects, h = given.P, given.effects, given.step
    c, s = math.cos(q), math.sin(q)
    bias = _load_torque(given.load, given.body, 0, q, c, s)
    F = 0.0
    for turn in range(2):
        t = -1.0 - h if turn == 0 else -h
        x = q - d if turn == 0 else q
        F = torque_now(P, 0, effects, X, 0, t, x, 0.0, math.inf)
        if P[effects] > 0.0:
            F += _effects(given, X, 0, t, x, 0.0, bias, c, s, asked)
    return bias - asked + F


@compiled
def _part(
    given: _Given,
    X: Vector,
    S: Vector,
    q: float,
    v: float,
    begin: int,
    end: int,
    position: Vector,
    drive: Vector,
) -> None:
    """Free steps from `begin` to `end`."""
    P, effects, load, body, h = given.P, given.effects, given.load, given.body, given.step
    motor, on = given.motor, given.on
    gain, emf, extra, lag = motor[0], motor[1], motor[2], motor[3]
    late = int(lag)
    part = lag - late
    some = P[effects] > 0.0
    for k in range(begin, end):
        i = min(k, load.shape[1] - 1)
        c, s = math.cos(q), math.sin(q)
        # a negative error beyond the armature is not inertia, see `replay.friction_spec`
        inertia = load[INERTIA, i] + max(extra, -body[0])
        bias = _load_torque(load, body, i, q, c, s)
        position[k] = q
        drive[k] = 0.0
        if on[k]:
            drive[k] = tick(given.B, S, k * h, given.target[k], q, v, given.supply[k])
        before = 0.0 if given.began else drive[0]
        first = drive[k - late] if k >= late else before
        second = drive[k - late - 1] if k > late else before
        torque = gain * ((1.0 - part) * first + part * second) if on[k] else 0.0
        brake = emf if on[k] else 0.0
        weight = 1.0 / inertia if inertia > 0.0 else 0.0
        rare_torque(P, 0, effects, X, 0, k * h, q, v, h, h, inertia, weight)
        F = X[TORQUE]
        if some:
            F += _effects(given, X, k, k * h, q, v, bias, c, s, torque - brake * v)
        damping = brake + X[GAIN]
        v = (inertia * v + h * (torque - F - bias)) / (inertia + h * damping)
        if not abs(v) < 1e6:  # diverged: what follows means nothing
            for later in range(k + 1, end):
                position[later] = 1e6
            return
        q += h * v


@compiled
def _along(given: _Given, X: Vector, S: Vector, begin: int, end: int, drive: Vector) -> None:
    """Drive friction, effects and controller along the measured motion from `begin` to `end`."""
    P, effects, load, body = given.P, given.effects, given.load, given.body
    gain, emf, on = given.motor[0], given.motor[1], given.on
    some = P[effects] > 0.0
    for k in range(begin, end):
        q, v, t = given.q[k], given.v[k], k * given.step
        drive[k] = tick(given.B, S, t, given.target[k], q, v, given.supply[k]) if on[k] else 0.0
        # 4: steps from one evaluation of the friction to the next along a measured motion, which is
        # smooth; a law is driven by displacement, and each step at one speed is exact
        if (k - begin) % 4 != 0:
            continue
        torque_now(P, 0, effects, X, 0, t, q, v, math.inf)
        if some:
            i = min(k, load.shape[1] - 1)
            c, s = math.cos(q), math.sin(q)
            bias = _load_torque(load, body, i, q, c, s)
            asked = gain * drive[k] - emf * v if on[k] else 0.0
            _effects(given, X, k, t, q, v, bias, c, s, asked)


@compiled
def _windows(
    given: _Given, X: Vector, S: Vector, window: int, position: Vector, drive: Vector
) -> None:
    """Free steps in windows from the measured motion, which X and S follow between them."""
    n = len(given.target)
    row, remembered = room(len(X)), room(len(S))
    for begin in range(0, n, window):
        end = min(begin + window, n)
        q, v = given.q[begin], given.v[begin]
        copy(X, row)
        copy(S, remembered)
        _part(given, row, remembered, q, v, begin, end, position, drive)
        if end < n:
            _along(given, X, S, begin, end, drive)
