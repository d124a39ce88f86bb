"""The linear side of the torque balance: columns and target of each log at given shapes.

    torque  = load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms       (torque known)
    current = (load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms) / g
    voltage = (load + Fc H(q; shape) + sigma1 dz/dt + sum of terms) / g            (gains unknown)

A voltage-driven joint has sigma2 only where the logs hold motion with the motor let go: elsewhere
what is linear in velocity is the effect `back-emf`, which a log of voltages cannot tell from
viscous friction. Nor has it sigma1 before that effect is in the model: on a soft transition curve
that damping would stand in for it.
"""

from collections.abc import Callable
from functools import partial
from threading import Lock

import numpy as np
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import DTAU, LOAD, MOTOR, RATE, H, Q, V
from frictionjoint.identify.motor_torque import saturated
from frictionjoint.identify.prepare import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import EffectTerm, Term, delay_of

# displacements, over the travel, over which friction may have come to what it held at first
_WAYS, _WAY_POINTS = (1e-7, 3.0), 60


def full_signals(segment: Segment, shape: Shape, Fc: float, sigma2: float) -> Array:
    """Signals with H, RATE, MOTOR and DTAU filled in for a law."""
    track = law_track(segment, shape)
    signals = segment.signals.copy()
    signals[:, H], signals[:, RATE] = track[:, 0], track[:, 1]
    signals[:, MOTOR] = balance(signals, Fc, sigma2)
    signals[:, DTAU] = np.gradient(signals[:, MOTOR], segment.dt)
    return signals


def balance(signals: Array, Fc: float, sigma2: float) -> Array:
    """Torque of the rigid body and a law along signals that hold H, N m, shape (n,)."""
    return np.asarray(signals[:, LOAD] + Fc * signals[:, H] + sigma2 * signals[:, V])


def law_track(segment: Segment, shape: Shape) -> Array:
    """H and dz/dq along a log, shape (n, 2)."""
    time, q = segment.path
    if segment.held:
        before = _approach(shape, segment)
        time = np.concatenate([time[0] + np.arange(-len(before), 0.0), time])
        q = np.concatenate([before, q])
    after = len(time) - len(segment.path[0])
    return np.column_stack([x[after :: segment.refine] for x in shape.hysteresis(time, q)])


def _approach(shape: Shape, segment: Segment) -> Array:
    """Positions, a second apart, over which a law that never moved comes to hold what it held.

    What came before a log is not known, and of the ways to a torque the straight one is taken. A
    law that never holds as much is brought to the most it holds.
    """
    q = segment.signals[:, Q]
    way = np.concatenate([[0.0], np.geomspace(*_WAYS, _WAY_POINTS) * (np.ptp(q) or 1.0)])
    way *= np.sign(segment.held)
    level = np.abs(shape.hysteresis(np.arange(float(len(way))), way)[0])
    enough = np.flatnonzero(level >= abs(segment.held))
    k = max(1, int(enough[0] if enough.size else np.argmax(level)))
    share = (abs(segment.held) - level[k - 1]) / ((level[k] - level[k - 1]) or 1.0)
    end = way[k - 1] + min(share, 1.0) * (way[k] - way[k - 1])
    return np.asarray(q[0] - end + way[:k])


def base_names(prepared: Prepared, law: Shape, terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Columns of the law alone: the load where the gain is unknown; v; H; dz/dt."""
    voltage = prepared.voltage_driven
    damped = law.damped and (not voltage or any(t.name == "back-emf" for t in terms))
    used = {
        "load": prepared.gain_unknown,
        "sigma2": prepared.let_go or not voltage,
        "Fc": True,
        "sigma1": damped,
    }
    return tuple(name for name, is_used in used.items() if is_used)


def column_names(prepared: Prepared, law: Shape, terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Columns of the law and the terms, those of a term as ``i.name``."""
    names = tuple(f"{i}.{c}" for i, term in enumerate(terms) for c in term.coefficients)
    return base_names(prepared, law, terms) + names


class ColumnCache:
    """Filtered columns of the latest points of a search: most stay from one point to the next.

    The rate of the torque (DTAU) in a fit is that of the rigid body alone, so that a search does
    not chase its own tail.
    """

    _LEAST, _A_LOG = 64, 24

    def __init__(self, logs: int = 1) -> None:
        self._most = max(self._LEAST, self._A_LOG * logs)
        self._kept: dict[object, Array] = {}
        self._lock = Lock()

    def get(self, key: object, make: Callable[[], Array]) -> Array:
        """The columns under a key, made if need be; points of a search ask side by side."""
        kept = self._kept.get(key)
        if kept is not None:
            return kept
        made = make()
        with self._lock:
            while len(self._kept) >= self._most:
                self._kept.pop(next(iter(self._kept)))
            self._kept[key] = made
        return made


def design(
    prepared: Prepared,
    shape: Shape,
    terms: tuple[Term, ...],
    cache: ColumnCache | None = None,
    beta: Array | None = None,
) -> tuple[Array, Array]:
    """Columns and target on the kept samples of all logs, filtered and decimated.

    Args:
        beta: coefficients that tell the torque of the motor; without them what depends on it is
            zero, see `motor_torque`.
    """
    cache = cache or ColumnCache(len(prepared))
    delay = delay_of(terms)
    X, y = [], []
    for i, segment in enumerate(prepared.segments):
        X.append(_log_columns(prepared, i, shape, terms, cache))
        target = partial(_target, segment, delay, prepared.gain_unknown)
        y.append(cache.get(("target", i, delay), target))
    whole = np.concatenate(X)
    if beta is not None:
        whole = saturated(whole, beta, column_names(prepared, shape, terms), terms)
    return whole, np.concatenate(y)


def _target(segment: Segment, delay: float, gain_unknown: bool) -> Array:
    drive = _filtered(segment, lambda: segment.drive_before(delay))
    return drive if gain_unknown else drive - load_torque(segment)


def load_torque(segment: Segment) -> Array:
    """Torque of the rigid body on the kept samples, filtered and decimated, N m."""
    return _filtered(segment, lambda: segment.signals[:, LOAD], differenced=True)


def _filtered(segment: Segment, make: Callable[[], Array], differenced: bool = False) -> Array:
    return segment.lowpass(make(), differenced)[segment.kept]


def _log_columns(
    prepared: Prepared, i: int, shape: Shape, terms: tuple[Term, ...], cache: ColumnCache
) -> Array:
    """Columns of one log, in the order of `base_names`, then the terms."""
    segment = prepared.segments[i]
    names = base_names(prepared, shape, terms)
    linear = [signal for name, signal in (("load", LOAD), ("sigma2", V)) if name in names]
    damped = "sigma1" in names

    def track() -> Array:
        return cache.get(("track", i, shape, segment.held), lambda: law_track(segment, shape))

    def law() -> Array:
        H_, rate = track().T
        return np.column_stack([H_, rate * segment.signals[:, V]] if damped else [H_])

    def still() -> Array:
        """Signals but for H: these do not change with the law."""
        signals = segment.signals.copy()
        signals[:, DTAU] = np.gradient(signals[:, LOAD], segment.dt)
        return signals

    def columns(term: Term) -> Array:
        signals = cache.get(("signals", i), still)
        if term.follows_law:
            signals = signals.copy()
            signals[:, H], signals[:, RATE] = track().T
        return term.columns(segment, signals)

    parts = [
        cache.get(
            ("linear", i),
            lambda: _filtered(segment, lambda: segment.signals[:, linear], differenced=True),
        ),
        cache.get(("law", i, shape, damped, segment.held), lambda: _filtered(segment, law)),
    ]
    for k, term in enumerate(terms):
        if not term.coefficients:
            continue  # it moves the drive
        key = (k, i, term.shape, (shape, segment.held) if term.follows_law else None)
        parts.append(
            cache.get(key, partial(_filtered, segment, partial(columns, term), term.differenced))
        )
    return np.column_stack(parts)


def coefficient_bounds(
    prepared: Prepared, law: Shape, terms: tuple[Term, ...]
) -> tuple[Array, Array]:
    """Physical signs: levels and gains are positive, terms have the bounds of their effects."""
    least = {"load": 1e-12, "Fc": 1e-12, "sigma1": 0.0, "sigma2": 0.0}
    low = [least[name] for name in base_names(prepared, law, terms)]
    high = [np.inf] * len(low)
    for term in terms:
        bounds: tuple[tuple[float, float], ...] = ()
        if isinstance(term, EffectTerm):
            bounds = term.effect.bounds
        free = ((-np.inf, np.inf),) * len(term.coefficients)
        # with an unknown gain only the sign of a bound survives
        for lo, hi in bounds or free:
            low.append(lo if lo == 0.0 or not prepared.gain_unknown else -np.inf)
            high.append(hi if not prepared.gain_unknown else np.inf)
    return np.array(low), np.array(high)


def lengths(X: Array) -> Array:
    """Norms of the columns to divide them by: 1 for those that are zero, shape (k,)."""
    norm: Array = np.linalg.norm(X, axis=0)
    norm[norm == 0.0] = 1.0
    return norm


def solve(X: Array, y: Array, low: Array, high: Array) -> Array:
    """Linear least squares, bounded only where the free solution breaks a bound."""
    scale, k = lengths(X), X.shape[1]
    # the triangle says all that the columns do, free or bounded, and is small
    triangle = np.asarray(np.linalg.qr(np.column_stack([X / scale, y]), mode="r"))
    R, z = triangle[:k, :k], triangle[:k, k]
    beta: Array = np.linalg.lstsq(R, z, rcond=1e-10)[0] / scale
    if np.all(beta >= low) and np.all(beta <= high):
        return beta
    found = lsq_linear(R, z, (low * scale, high * scale), method="bvls")
    # rounding puts a coefficient that is on its bound beyond it
    return np.asarray(np.clip(found.x / scale, low, high))
