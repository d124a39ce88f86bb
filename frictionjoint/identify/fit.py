"""Least squares of the torque balance: friction law plus terms, on one or several logs.

Everything is linear but the shapes, so the shapes are searched and the rest is solved for at each
trial point (variable projection, Golub and Pereyra 1973); `design` has the linear side.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.design import (
    ColumnCache,
    coefficient_bounds,
    column_names,
    design,
    load_torque,
    solve,
)
from frictionjoint.identify.motor_torque import solutions
from frictionjoint.identify.prepare import Drive, Prepared
from frictionjoint.identify.shape import INTEGRATED, Shape
from frictionjoint.identify.terms import Term
from frictionjoint.threads import one_thread, side_by_side

# share of a range within which a search has arrived at the range's end
_ON_BOUND = 1e-4
# samples that a search among many starts looks at
_COARSE = 6000
# how many of the starts of a search go on, after how many steps of each
_HALVING = ((6, 3), (3, 8))
# steps of those on all samples before the best goes on alone, and the share of the best one's cost
# up to which they are tried there
_FINAL_STEPS, _NEAR_BEST = 3, 1.5
_MOST_STEPS, _FEW_STEPS = 15, 6
# relative change of the squares at which a search ends
CLOSE, ROUGH = 1e-6, 1e-3


@dataclass(frozen=True)
class Fit:
    """A fitted model.

    Attributes:
        shape: of the law; terms: beside it. drive: what the logs hold of the motor.
        beta: linear coefficients, one a column, in the drive's units (see `gain`).
        gain: torque per unit of drive; 1 where the torque is measured.
        names: of the columns, those of `base_names` first.
        residual: drive minus model times gain, N m, kept samples of all logs in turn, shape (n,).
        jacobian: of the model in N m by every parameter, linear ones first, shape (n, p).
        bound: which parameters sit on a bound of their range, shape (p,).
        log_index: which log each sample belongs to, shape (n,).
        target_rms: rms of the measured torque.
    """

    shape: Shape
    terms: tuple[Term, ...]
    drive: Drive
    beta: Array
    gain: float
    names: tuple[str, ...]
    residual: Array
    jacobian: Array
    bound: NDArray[np.bool_]
    log_index: NDArray[np.int64]
    target_rms: float

    @property
    def rms(self) -> float:
        """rms of the residual, N m."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def drive_rms(self) -> float:
        """rms of the residual in units of the drive, to compare fits whose gains differ."""
        return self.rms / self.gain

    @property
    def free_jacobian(self) -> Array:
        """Columns of the parameters that can still move either way, shape (n, free)."""
        return self.jacobian[:, ~self.bound]

    @property
    def friction(self) -> Array:
        """Torque of the law alone, N m, shape (n,)."""
        at = [self.names.index(n) for n in ("Fc", "sigma1", "sigma2") if n in self.names]
        return np.asarray(self.jacobian[:, at] @ self.beta[at])

    def coefficient(self, name: str) -> float:
        """A linear coefficient in N m per unit of its column."""
        return float(self.beta[self.names.index(name)] * self.gain)

    @property
    def levels(self) -> tuple[float, float]:
        """Fc, and sigma2 or 0 where the fit has none, N m and N m s/rad."""
        sigma2 = self.coefficient("sigma2") if "sigma2" in self.names else 0.0
        return self.coefficient("Fc"), sigma2

    def term_coefficients(self, i: int) -> Array:
        """Coefficients of term i in N m per unit of their columns."""
        first = len(self.names) - sum(len(t.coefficients) for t in self.terms[i:])
        return self.beta[first : first + len(self.terms[i].coefficients)] * self.gain


def shape_limits(term: Term) -> tuple[tuple[float, float], ...]:
    """Physical range of each shape number that a search may move."""
    return term.limits or ((-np.inf, np.inf),) * len(term.free_shape)


@one_thread
def fit(
    prepared: Prepared,
    terms: tuple[Term, ...] = (),
    start: Shape | None = None,
    progress: Callable[[str], None] = lambda text: None,
    closeness: float = CLOSE,
    forms: Sequence[Shape] = INTEGRATED,
) -> Fit:
    """Fit the law and the terms.

    Args:
        start: shape to start from (a refit); without one several starts are tried.
        closeness: share of the squares by which the last step may still lower them; a refit that
            is only compared with others does with `ROUGH`.
        forms: of the law, each tried where there is no `start`.
    """
    if start:
        outer = _Outer(prepared, terms, start)
        steps = _MOST_STEPS if closeness == CLOSE else _FEW_STEPS
        return outer.result(_refined(outer, outer.start, steps, closeness).x)
    coarse, cache = prepared.thinned(_COARSE), ColumnCache(len(prepared))
    # laws of different variables ripen at different speeds: the best of each is compared when done
    laws: dict[tuple[str, ...], list[tuple[_Outer, Array]]] = {}
    for i, form in enumerate(forms):
        progress(f"fit: form {i + 1} of {len(forms)}")
        outer = _Outer(coarse, terms, form, cache)
        laws.setdefault(form.variables, []).append((outer, outer.best_of_grid()))
    ripe: list[_Place] = []
    for i, places in enumerate(laws.values()):
        for keep, steps in _HALVING:
            progress(f"fit: law {i + 1} of {len(laws)}, the better of {len(places)} starts")
            found = [_refined(outer, x, steps, ROUGH) for outer, x in places]
            found.sort(key=lambda place: place.cost)
            places = [(place.outer, place.x) for place in found[:keep]]
        if len(laws) > 1:
            found = [_refined(*places[0], _MOST_STEPS, ROUGH)]
        ripe += found[: len(places)]
    best = min(place.cost for place in ripe)
    ripe = [place for place in ripe if place.cost <= _NEAR_BEST * best]
    final = []
    for i, place in enumerate(ripe):
        progress(f"fit: all samples, start {i + 1} of {len(ripe)}")
        shape, terms = place.outer.split(place.x)
        outers = [_Outer(prepared, terms, choice) for choice in shape.last_choices()]
        outer = min(outers, key=lambda o: float(np.sum(o.residual(o.start) ** 2)))
        alone = _Place(0.0, outer, outer.start)
        final.append(_refined(*alone[1:], _FINAL_STEPS, ROUGH) if len(ripe) > 1 else alone)
    progress("fit: refining")
    place = min(final, key=lambda place: place.cost)
    place = _refined(place.outer, place.x, _MOST_STEPS, closeness)
    return place.outer.result(place.x)


class _Place(NamedTuple):
    """Where a search has come to: half the sum of squares there, its search, the numbers."""

    cost: float
    outer: "_Outer"
    x: Array


def _refined(outer: "_Outer", x: Array, steps: int, closeness: float) -> _Place:
    """Where some steps of a search from x lead."""
    with side_by_side() as each:
        found = least_squares(
            outer.residual,
            x,
            bounds=outer.bounds,
            diff_step=1e-3,
            x_scale=outer.scale,
            max_nfev=steps,
            xtol=1e-4,
            ftol=closeness,
            workers=each,
        )
    return _Place(float(found.cost), outer, found.x)


class _Outer:
    """The search over shapes, from a law and terms; the rest is solved for at each point."""

    def __init__(
        self,
        prepared: Prepared,
        terms: tuple[Term, ...],
        law: Shape,
        cache: ColumnCache | None = None,
    ) -> None:
        self.prepared = prepared
        self.terms = terms
        self.law = law
        self.cache = cache or ColumnCache(len(prepared))
        speeds = np.concatenate([np.abs(s.signals[:, V]) for s in prepared.segments])
        self.vmax = float(np.quantile(speeds, 0.99)) or 1.0
        self.span = max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments)
        low, high = (list(x) for x in law.bounds(self.vmax, self.span))
        for term in terms:
            limits = shape_limits(term)
            for i, (x, (least, most)) in enumerate(zip(term.free_shape, limits, strict=True)):
                reach = self._reach(term, i)
                low.append(max(x - reach, least))
                high.append(min(x + reach, most))
        self.bounds: tuple[Array, Array] = (np.array(low), np.array(high))
        self.scale = np.minimum(1.0, 0.25 * (self.bounds[1] - self.bounds[0]))
        self.low, self.high = coefficient_bounds(prepared, law, terms)

    def _reach(self, term: Term, i: int) -> float:
        x = term.free_shape[i]
        if term.name == "position-periodic" and i == 0:
            return np.pi / self.span / 2.0
        if x == 0.0:
            return np.inf  # not sought yet: the physical range decides
        return 0.6 * abs(x) + 1e-12

    @property
    def start(self) -> Array:
        """Where the law and the terms given lie."""
        return self.vector(self.law)

    def vector(self, law: Shape) -> Array:
        x: Array = np.array([*law.vector(), *(n for term in self.terms for n in term.free_shape)])
        inside = 1e-6 * (self.bounds[1] - self.bounds[0])
        return np.clip(x, self.bounds[0] + inside, self.bounds[1] - inside)

    def split(self, x: Array) -> tuple[Shape, tuple[Term, ...]]:
        at, terms = len(self.law.variables), []
        shape = self.law.moved(x[:at])
        for term in self.terms:
            k = len(term.free_shape)
            moved = tuple(float(n) for n in x[at : at + k])
            terms.append(term.with_shape(moved) if k else term)
            at += k
        return shape, tuple(terms)

    def best_of_grid(self) -> Array:
        """Best point of a coarse grid."""
        points = [self.vector(law) for law in self.law.grid(self.vmax, self.span)]
        with side_by_side() as each:
            squares = [float(np.sum(e**2)) for e in each(self.residual, points)]
        return points[int(np.argmin(squares))]

    def solved(self, x: Array) -> tuple[Array, Array, Array]:
        shape, terms = self.split(x)
        X, y = design(self.prepared, shape, terms, self.cache)
        beta = solve(X, y, self.low, self.high)
        for _ in range(solutions(terms) - 1):
            X, _ = design(self.prepared, shape, terms, self.cache, beta)
            beta = solve(X, y, self.low, self.high)
        return X, y, beta

    def residual(self, x: Array) -> Array:
        X, y, beta = self.solved(x)
        out: Array = y - X @ beta
        return out

    def result(self, x: Array) -> Fit:
        X, y, beta = self.solved(x)
        shape, terms = self.split(x)
        names = column_names(self.prepared, shape, terms)
        gain = float(1.0 / beta[0]) if self.prepared.gain_unknown else 1.0
        model = X @ beta

        def by_number(i: int) -> Array:
            h = 1e-3 * self.scale[i]
            inward = -h if x[i] + h > self.bounds[1][i] else h
            moved = x.copy()
            moved[i] += inward
            other_shape, other_terms = self.split(moved)
            X2, y2 = design(self.prepared, other_shape, other_terms, self.cache, beta)
            # a delay moves the drive
            return np.asarray(((X2 @ beta - y2) - (model - y)) / inward)

        with side_by_side() as each:
            shape_columns = list(each(by_number, range(len(x))))
        index = np.concatenate(
            [np.full(int(s.kept.sum()), i) for i, s in enumerate(self.prepared.segments)]
        )
        total = y + (0.0 if self.prepared.gain_unknown else self._load())
        return Fit(
            shape=shape,
            terms=terms,
            drive=self.prepared.drive,
            beta=beta,
            gain=gain,
            names=names,
            residual=(y - model) * gain,
            jacobian=np.column_stack([X, *shape_columns]) * gain,
            bound=np.concatenate([(beta <= self.low) | (beta >= self.high), self._near_bound(x)]),
            log_index=index,
            target_rms=float(np.sqrt(np.mean((total * gain) ** 2))),
        )

    def _near_bound(self, x: Array) -> NDArray[np.bool_]:
        near = _ON_BOUND * (self.bounds[1] - self.bounds[0])
        return (x - self.bounds[0] <= near) | (self.bounds[1] - x <= near)

    def _load(self) -> Array:
        return np.concatenate([load_torque(s) for s in self.prepared.segments])
