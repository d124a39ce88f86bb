"""The torque balance of a model: columns and target of each log, and how they move.

    torque  = load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms       (torque known)
    current = (load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms) / g
    voltage = (load + Fc H(q; shape) + sigma1 dz/dt + sum of terms) / g            (gains unknown)

All columns and the target pass the same filter (`Segment.lowpass`).
"""

from collections.abc import Callable
from functools import partial
from threading import Lock

import numpy as np
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, MOTOR, RATE, H, Q, V
from frictionjoint.identify.layout import Layout, layout_of
from frictionjoint.identify.motor_torque import with_motor
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.terms import (
    DriveTerm,
    EffectTerm,
    Term,
    Timing,
    changed_drive,
    delay_of,
)
from frictionjoint.threads import side_by_side

# displacements, over the travel, over which friction may have come to what it held at first
_REACHED, _POINTS = (1e-7, 3.0), 60
# how far a term's shape number may move in one search, over itself
_REACH = 0.6
# step of such a number over that: the kernels of effects carry no tangents of their own, and a gap
# or a stop has none at an impact
_STEP = 0.015
# of H along a law's tangent
_SMALL = 1e-4
# columns of the latest points of a search are kept: most stay from one point to the next
_KEPT_A_LOG = 24


class Balance:
    """The balance of some logs, for models of one law and one list of terms.

    Attributes:
        prepared: the logs. layout: of the model's parameters. span: longest travel of a log.
    """

    def __init__(self, prepared: Prepared, law: Shape, terms: tuple[Term, ...]) -> None:
        self.prepared = prepared
        self.layout: Layout = layout_of(prepared, law, terms)
        self.span = max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments)
        self._kept: dict[object, Array] = {}
        self._latest: dict[int, tuple[object, Segment]] = {}
        self._lock = Lock()

    def columns(
        self, law: Shape, terms: tuple[Term, ...], beta: Array | None = None
    ) -> tuple[Array, Array]:
        """Columns, shape (n, k), and target, shape (n,), on the kept samples of all logs.

        Args:
            beta: coefficients that give the torque of the motor; without them what depends on it
                is zero, see `motor_torque`.
        """
        delay = delay_of(terms)
        with side_by_side() as each:
            X = list(each(partial(self._log_columns, law, terms), range(len(self.prepared))))
        y = [self._target(terms, delay, i) for i in range(len(X))]
        whole = np.concatenate(X)
        if beta is not None:
            whole = with_motor(whole, beta, self.layout, self.prepared.segments)
        return whole, np.concatenate(y)

    def moves(
        self, law: Shape, terms: tuple[Term, ...], beta: Array, through_terms: bool = True
    ) -> Array:
        """Derivative of columns times `beta` less target by every nonlinear number, shape (n, m).

        The law's own are carried through its kernel along with its torque.

        Args:
            through_terms: with what the law changes in terms that follow it, which a search does
                without.
        """
        make = partial(self._log_moves, law, terms, beta, through_terms)
        with side_by_side() as each:
            found = list(each(make, range(len(self.prepared))))
        return np.concatenate(found)

    def _log_columns(self, law: Shape, terms: tuple[Term, ...], i: int) -> Array:
        s, names = self.prepared.segments[i], self.layout.base
        parts = []
        if "load" in names:
            parts.append(load_torque(s)[:, None])
        if "sigma2" in names:
            parts.append(s.balanced_velocity[:, None])
        parts.append(self._get(("law", i, law), partial(self._law, law, i)))
        for term in terms:
            if term.coefficients:
                key = (i, id_of(term), law if term.follows_law else None)
                parts.append(self._get(key, partial(self._term, term, law, i)))
        return np.column_stack(parts)

    def of_law(self, law: Shape, terms: tuple[Term, ...], beta: Array, i: int) -> Array:
        """What the law and the terms that follow it add up to in a log, shape (n,)."""
        at = [self.layout.base.index(x) for x in ("Fc", "sigma1") if x in self.layout.base]
        found = self._law(law, i) @ beta[at]
        for k, term in enumerate(terms):
            if term.follows_law:
                found += self._term(term, law, i) @ beta[self.layout.coefficients(k)]
        return np.asarray(found)

    def _target(self, terms: tuple[Term, ...], delay: float, i: int) -> Array:
        changes = tuple(id_of(t) for t in terms if isinstance(t, DriveTerm))

        def make() -> Array:
            return target(self._driven(terms, i), self.prepared, delay)

        return self._get(("target", i, delay, changes), make)

    def _law(self, law: Shape, i: int) -> Array:
        s = self.prepared.segments[i]
        track = self._track(law, i)
        if "sigma1" not in self.layout.base:
            return kept(s, track[:, :1])
        return kept(s, np.column_stack([track[:, 0], track[:, 1] * s.signals[:, V]]))

    def _term(self, term: Term, law: Shape, i: int) -> Array:
        s = self.prepared.segments[i]
        return kept(s, term.columns(s, self._signals(term, law, i)))

    def _signals(self, term: Term, law: Shape, i: int) -> Array:
        signals = self.prepared.segments[i].signals
        if term.follows_law:
            signals = signals.copy()
            signals[:, H], signals[:, RATE] = self._track(law, i).T
        return signals

    def _driven(self, terms: tuple[Term, ...], i: int) -> Segment:
        """A log with the drive that these terms make of its commands.

        The latest one of each log is kept: what else moves leaves it as it is.
        """
        changes = tuple(id_of(t) for t in terms if isinstance(t, DriveTerm))
        known, found = self._latest.get(i, (None, None))
        if found is None or known != changes:
            found = changed_drive(self.prepared.segments[i], terms)
            self._latest[i] = changes, found
        return found

    def _track(self, law: Shape, i: int) -> Array:
        return self._get(("track", i, law), lambda: law_track(self.prepared.segments[i], law))

    def _log_moves(
        self, law: Shape, terms: tuple[Term, ...], beta: Array, through_terms: bool, i: int
    ) -> Array:
        s, layout = self.prepared.segments[i], self.layout
        found = list(self._law_moves(law, terms if through_terms else (), beta, i).T)
        for k, term in enumerate(terms):
            for j, (x, reach) in enumerate(reaches(term, self.span)):
                if isinstance(term, DriveTerm):
                    found.append(self._drive_move(terms, k, j, i))
                    continue
                if term.delay or not term.coefficients:
                    # the drive of an earlier time
                    earlier = self._driven(terms, i).balanced_drive(delay_of(terms), 1)
                    found.append(earlier[s.kept])
                    continue
                h = _STEP * reach if np.isfinite(reach) else _SMALL
                pair = [
                    self._term(term.with_shape(_with(term.free_shape, j, x + d)), law, i)
                    for d in (h, -h)
                ]
                found.append((pair[0] - pair[1]) @ beta[layout.coefficients(k)] / (2.0 * h))
        return np.column_stack(found) if found else np.zeros((int(s.kept.sum()), 0))

    def _drive_move(self, terms: tuple[Term, ...], k: int, j: int, i: int) -> Array:
        """By number j of term k, an effect of the drive, shape (n,)."""
        x = terms[k].free_shape[j]
        h = _STEP * abs(x) or _STEP
        moved = terms[k].with_shape(_with(terms[k].free_shape, j, x + h))
        delay = delay_of(terms)
        s = changed_drive(self.prepared.segments[i], (*terms[:k], moved, *terms[k + 1 :]))
        there = target(s, self.prepared, delay)
        return np.asarray((self._target(terms, delay, i) - there) / h)

    def _law_moves(self, law: Shape, terms: tuple[Term, ...], beta: Array, i: int) -> Array:
        """By the numbers of the law, shape (n, number)."""
        s, layout = self.prepared.segments[i], self.layout
        dH, drate = law_tangents(s, law)
        torque = beta[layout.base.index("Fc")] * dH
        if "sigma1" in layout.base:
            torque += beta[layout.base.index("sigma1")] * drate * s.signals[:, V]
        for k, term in enumerate(terms):
            if not term.follows_law:
                continue
            signals = self._signals(term, law, i).copy()
            own, weights = signals[:, H].copy(), beta[layout.coefficients(k)]
            here = term.columns(s, signals) @ weights
            for j, tangent in enumerate(dH):
                # these columns are linear in H, but for a bound on it
                h = _SMALL / (float(np.abs(tangent).max()) or 1.0)
                signals[:, H] = own + h * tangent
                torque[j] += (term.columns(s, signals) @ weights - here) / h
        return kept(s, torque.T)

    def _get(self, key: object, make: Callable[[], Array]) -> Array:
        """The columns under a key, made if need be; logs ask side by side."""
        found = self._kept.get(key)
        if found is not None:
            return found
        made = make()
        with self._lock:
            while len(self._kept) >= _KEPT_A_LOG * len(self.prepared):
                self._kept.pop(next(iter(self._kept)))
            self._kept[key] = made
        return made


def reaches(term: Term, span: float) -> list[tuple[float, float]]:
    """Each free shape number of a term and how far it may move in one search.

    Args:
        span: travel of the joint.
    """
    found = []
    for i, x in enumerate(term.free_shape):
        if isinstance(term, Timing):
            reach = np.inf
        elif isinstance(term, EffectTerm) and term.effect.proposed_by == "spectrum" and i == 0:
            reach = np.pi / span / 2.0  # between the lines of a spectrum
        else:
            # a zero was not searched yet: the physical range decides
            reach = _REACH * abs(x) + 1e-12 if x else np.inf
        found.append((x, reach))
    return found


def id_of(term: Term) -> tuple[str, tuple[float, ...], object]:
    """What makes the columns of a term what they are."""
    return term.name, term.shape, term


def _with(shape: tuple[float, ...], j: int, x: float) -> tuple[float, ...]:
    return (*shape[:j], x, *shape[j + 1 :])


def kept(segment: Segment, x: Array) -> Array:
    """What the balance keeps of signals of a log."""
    return segment.lowpass(x)[segment.kept]


def target(segment: Segment, prepared: Prepared, delay: float) -> Array:
    """What the columns are to add up to on the kept samples of a log."""
    drive = segment.balanced_drive(delay)[segment.kept]
    return drive if prepared.gain_unknown else drive - load_torque(segment)


def load_torque(segment: Segment) -> Array:
    """Torque of the rigid body on the kept samples, N m."""
    return segment.balanced_load


def full_signals(segment: Segment, shape: Shape, Fc: float, sigma2: float) -> Array:
    """Signals with H, RATE and MOTOR filled in for a law."""
    track = law_track(segment, shape)
    signals = segment.signals.copy()
    signals[:, H], signals[:, RATE] = track[:, 0], track[:, 1]
    signals[:, MOTOR] = balance(signals, Fc, sigma2)
    return signals


def balance(signals: Array, Fc: float, sigma2: float) -> Array:
    """Torque of the rigid body and a law along signals that hold H, N m, shape (n,)."""
    return np.asarray(signals[:, LOAD] + Fc * signals[:, H] + sigma2 * signals[:, V])


def law_track(segment: Segment, shape: Shape) -> Array:
    """H and dz/dq along a log, shape (n, 2)."""
    time, q, before = _whole_path(segment, shape)
    found = shape.hysteresis(time, q)
    return segment.path.on_grid(np.column_stack([x[before:] for x in found]))


def law_tangents(segment: Segment, shape: Shape) -> tuple[Array, Array]:
    """Derivatives of H and dz/dq by the numbers of a shape along a log, each of shape (k, n)."""
    time, q, before = _whole_path(segment, shape)
    _, _, *moves = shape.tangents(time, q)
    dH, drate = (segment.path.on_grid(x[:, before:].T).T for x in moves)
    return dH, drate


def _whole_path(segment: Segment, shape: Shape) -> tuple[Array, Array, int]:
    """Time and position that a law is driven along, and how many of them come before the log."""
    time, q = segment.path.time, segment.path.position
    if not segment.held:
        return time, q, 0
    before = _approach(shape, segment)
    time = np.concatenate([time[0] + np.arange(-len(before), 0.0), time])
    return time, np.concatenate([before, q]), len(before)


def _approach(shape: Shape, segment: Segment) -> Array:
    """Positions, a second apart, over which a law that never moved comes to hold what it held.

    What came before a log is not known, and of the ways to a torque the straight one is taken. A
    law that never holds as much is brought to the most it holds.
    """
    q = segment.signals[:, Q]
    way = np.concatenate([[0.0], np.geomspace(*_REACHED, _POINTS) * (np.ptp(q) or 1.0)])
    way *= np.sign(segment.held)
    level = np.abs(shape.hysteresis(np.arange(float(len(way))), way)[0])
    enough = np.flatnonzero(level >= abs(segment.held))
    k = max(1, int(enough[0] if enough.size else np.argmax(level)))
    fraction = (abs(segment.held) - level[k - 1]) / ((level[k] - level[k - 1]) or 1.0)
    end = way[k - 1] + min(fraction, 1.0) * (way[k] - way[k - 1])
    return np.asarray(q[0] - end + way[:k])


def coefficient_bounds(prepared: Prepared, layout: Layout) -> tuple[Array, Array]:
    """Physical signs: levels and gains are positive, terms have the bounds of their effects."""
    least = {"load": 1e-12, "Fc": 1e-12, "sigma1": 0.0, "sigma2": 0.0}
    pairs = [(least[name], np.inf) for name in layout.base]
    for term in layout.terms:
        pairs += term_bounds(prepared, term)
    low, high = np.array(pairs).T
    return low, high


def term_bounds(prepared: Prepared, term: Term) -> list[tuple[float, float]]:
    """Range of each coefficient of a term, in units of the drive."""
    bounds: tuple[tuple[float, float], ...] = ()
    unit = 1.0
    if isinstance(term, SmoothTerm):
        bounds = term.bounds
    elif isinstance(term, EffectTerm):
        bounds = term.effect.bounds
        if term.effect.of_inertia:
            unit = float(np.median([s.noise.inertia for s in prepared.segments]))
    # with an unknown gain only the sign of a bound survives
    survives = not prepared.gain_unknown or unit != 1.0
    return [
        (lo * unit if lo == 0.0 or survives else -np.inf, hi * unit if survives else np.inf)
        for lo, hi in bounds or ((-np.inf, np.inf),) * len(term.coefficients)
    ]


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
