"""Least squares of the torque balance: friction law and terms, on one or several logs.

Everything but the shapes is linear, so the shapes are searched and the rest is solved at each point
(variable projection, Golub and Pereyra 1973, with Kaufman's derivative, 1975).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import MOTOR, Q
from frictionjoint.identify.design import Balance, coefficient_bounds, reaches, solve
from frictionjoint.identify.fit import Fit, implied_share
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term, in_place, swings_of, timed
from frictionjoint.threads import one_thread

# relative change of the squares at which a search ends
CLOSE, ROUGH = 1e-6, 1e-3
# least that a drive may come to: to compare errors over it
_HARDLY = 1e-9
# highest resonance that still shows in the band of the balance, over its corner
HEARD = 2.0
# relative change of a share that does not change a fit noticeably
_SHARE_RESOLUTION = 0.05
# waves in the usual range of positions, or the longest log: fewer are nearly any curve. A fit may
# move a wave by half of one, which is the width of a line of the spectrum.
FEWEST_WAVES, HALF_A_WAVE = 1.5, 0.5


@one_thread
def refit(
    prepared: Prepared,
    terms: tuple[Term, ...],
    start: Shape,
    closeness: float = CLOSE,
    steps: int = 20,
) -> Fit:
    """Fit a law from one start, and terms from their own shapes, in so many steps, or until a step
    reduces the sum of squares by less than the fraction `closeness`."""
    search = Search(prepared, timed(prepared, terms, start), start)
    found = search.result(search.run(search.start, steps, closeness).x)
    return with_parts(prepared, found, steps, closeness)


def with_parts(prepared: Prepared, found: Fit, steps: int, closeness: float) -> Fit:
    """A fit in which each spring carries the share of the inertia that its coefficient implies, or
    the one that leaves the smallest residual.

    Fit and implied share in turn would not converge: with a share that is too small, the fitted
    inertia is too small as well.
    """
    for i in range(len(found.terms)):
        term = found.terms[i]
        if not (isinstance(term, EffectTerm) and term.effect.of_inertia):
            continue
        share = implied_share(prepared, found, i)
        if abs(share - term.part) <= _SHARE_RESOLUTION * term.part:
            continue
        free: Term = replace(term, part=share, part_searched=True)
        search = Search(prepared, in_place(found.terms, i, free), found.shape)
        shape, terms = search.split(search.run(search.start, steps, closeness).x)
        best = terms[i]
        assert isinstance(best, EffectTerm)
        last = Search(prepared, in_place(terms, i, replace(best, part_searched=False)), shape)
        found = best_of([found, last.result(last.start)], lambda f: f.drive_rms)
    return found


def nearer(prepared: Prepared, terms: tuple[Term, ...], laws: Sequence[Shape]) -> Shape:
    """The shape of a law with the smallest residual, with given terms."""
    if len(laws) == 1:
        return laws[0]
    searches = [Search(prepared, timed(prepared, terms, law), law) for law in laws]
    return best_of(searches, lambda search: search.squares(search.start)).law


class Solution(NamedTuple):
    """Columns, target and coefficients at a point of a search, in units of the drive, `Fit.acting`,
    and the factor on an error before it is minimised."""

    X: Array
    y: Array
    beta: Array
    acting: float
    unit: float


class Place(NamedTuple):
    """State of a search: half the sum of squares, the search, the numbers."""

    cost: float
    search: "Search"
    x: Array

    @property
    def law(self) -> Shape:
        """The law at this point."""
        return self.search.split(self.x)[0]


class Search:
    """The search over shapes, from a law and terms; the rest is solved for at each point."""

    def __init__(self, prepared: Prepared, terms: tuple[Term, ...], law: Shape) -> None:
        self.prepared = prepared
        self.terms = terms
        self.law = law
        self.layout = layout_of(prepared, law, terms)
        self.balance = Balance(prepared, law, terms)
        self.bounds = self._ranges(law, terms)
        self.scale = np.minimum(1.0, 0.25 * (self.bounds[1] - self.bounds[0]))
        self.low, self.high = coefficient_bounds(prepared, self.layout)
        self.weight = prepared.weight
        # what an effect of the drive takes away must not pass for a small error
        self.size = self._size(prepared.balanced_drive)
        self._at_law = law.vector()
        # searches from several starts run side by side: read once
        self._last: tuple[bytes, Solution] | None = None

    def _ranges(self, law: Shape, terms: tuple[Term, ...]) -> tuple[Array, Array]:
        """Ranges of the numbers of a law, and of those of terms around their present values."""
        low, high = (list(x) for x in law.bounds(self.prepared.bounding_speed, self.balance.span))
        for term in terms:
            for (least, most), (x, reach) in zip(
                self._limits(term), reaches(term, self.balance.span), strict=True
            ):
                low.append(max(x - reach, least))
                high.append(min(x + reach, most))
        return np.array(low), np.array(high)

    def _limits(self, term: Term) -> list[tuple[float, float]]:
        """Physical ranges; a frequency in time is limited to the band of the balance, and one in
        position to at least one wave per turn."""
        limits = list(term.limits)
        if isinstance(term, EffectTerm):
            if term.effect.is_wave:
                wave, now = 2.0 * math.pi / self.prepared.usual_travel, term.free_shape[0]
                least = (FEWEST_WAVES - HALF_A_WAVE) * wave
                limits[0] = min(now, HALF_A_WAVE * wave) if now < least else least, limits[0][1]
            top = HEARD * self.prepared.band.balance
            for i, unit in enumerate(term.effect.shape_units[: len(limits)]):
                if unit == "Hz":
                    limits[i] = (limits[i][0], max(min(limits[i][1], top), 1.01 * limits[i][0]))
        return limits

    @property
    def start(self) -> Array:
        """Numbers of the given law and terms, within their bounds."""
        x: Array = np.array(
            [*self.law.vector(), *(n for term in self.terms for n in term.free_shape)]
        )
        span = self.bounds[1] - self.bounds[0]
        # a number at zero may go as far up as physics lets it: its range may have no end
        inside = 1e-6 * np.where(np.isfinite(span), span, 1.0 + np.abs(x))
        return np.clip(x, self.bounds[0] + inside, self.bounds[1] - inside)

    def split(self, x: Array) -> tuple[Shape, tuple[Term, ...]]:
        """The law and the terms at a point."""
        numbers = x[: len(self.layout.law)]
        # the law at the start is known along the logs, unlike one that differs by rounding
        law = self.law if np.array_equal(numbers, self._at_law) else self.law.moved(numbers)
        return law, self.layout.moved_terms(x)

    def run(self, x: Array, steps: int, closeness: float) -> Place:
        """Result of some steps from x, then of finite steps of the discontinuous numbers."""
        place = self._descended(x, steps, closeness)
        axes = self.leaping if closeness <= CLOSE else []
        # at most three rounds of finite steps, each with a gain of 0.1% or more
        for _ in range(3 if axes else 0):
            there = pattern_search(self.squares, place.x, axes, *self.bounds)
            found = self._descended(there, steps, closeness)
            gained = place.cost - found.cost
            place = best_of([place, found], lambda p: p.cost)
            if gained <= 1e-3 * place.cost:
                break
        return place

    @property
    def leaping(self) -> list[int]:
        """Indices of the numbers with discontinuous influence on the torque."""
        leap = (i for i, term in enumerate(self.terms) if term.effect.leaps)
        return [k for i in leap for k in range(len(self.scale))[self.layout.searched(i)]]

    def squares(self, x: Array) -> float:
        """Residual sum of squares at a point."""
        return float(np.sum(self.residual(x) ** 2))

    def _descended(self, x: Array, steps: int, closeness: float) -> Place:
        """Result of steps along derivatives.

        A change of a parameter by its scale costs as much as the last step may gain. Otherwise a
        parameter with hardly any influence (a part of a curve that the motion does not reach) would
        follow rounding errors, because a step that a trust region shortens has the length of the
        region in any case.
        """
        still, axes = np.zeros(len(x)), np.diag(1.0 / self.scale)

        def residual(at: Array) -> Array:
            self.balance.differentiate(self.split(at)[0])
            return np.concatenate([self.residual(at), still])

        def derivative(at: Array) -> Array:
            return np.vstack([self.derivative(at), math.sqrt(closeness * self.squares(at)) * axes])

        found = least_squares(
            residual,
            x,
            jac=derivative,
            bounds=self.bounds,
            x_scale=self.scale,
            max_nfev=steps,
            xtol=1e-4,
            ftol=closeness,
        )
        return Place(float(found.cost), self, found.x)

    def solved(self, x: Array) -> Solution:
        """Columns, target and coefficients at a point."""
        key = x.tobytes()
        last = self._last
        if last and last[0] == key:
            return last[1]
        shape, terms = self.split(x)
        X, y = self.balance.columns(shape, terms)
        beta = self._coefficients(X, y)
        # the torque of a motor and the coefficients change each other little
        for _ in range(3 * any(MOTOR in term.effect.needs for term in terms)):
            X, _ = self.balance.columns(shape, terms, beta)
            beta = self._coefficients(X, y)
        acting = self._acting(terms, y)
        # a gain that is open would make an error small together with the drive
        unit = 1.0 / acting if self.prepared.gain_unknown else 1.0
        found = Solution(X, y, beta, acting, unit)
        self._last = (key, found)
        return found

    def _coefficients(self, X: Array, y: Array) -> Array:
        """Best coefficients; a law without a friction level has no damping sigma1."""
        columns = self.layout.with_load(X) * self.weight[:, None]
        wanted = self.layout.less_load(X, y) * self.weight
        beta = solve(columns, wanted, self.low, self.high)
        names = self.layout.base
        if "sigma1" in names:
            level, damping = names.index("Fc"), names.index("sigma1")
            if beta[level] <= self.low[level] and beta[damping] > 0.0:
                columns[:, damping] = 0.0
                beta = solve(columns, wanted, self.low, self.high)
        return self.layout.with_sizes(beta)

    def _size(self, y: Array) -> float:
        return float(np.linalg.norm(y * self.weight))

    def _acting(self, terms: tuple[Term, ...], y: Array) -> float:
        """Weighted rms of the drive, relative to that before effects of the drive changed it."""
        if not any(isinstance(t, DriveTerm) for t in terms):
            return 1.0
        return max(self._size(self._drive(y)) / self.size, _HARDLY)

    def _holding(self, terms: tuple[Term, ...], X: Array, beta: Array) -> float:
        """Torque per small error of position, relative to that before effects changed it."""
        if not self.prepared.commanded:
            return 1.0
        own = [(term, self.layout.coefficients(i)) for i, term in enumerate(terms)]
        scaling = [1.0 + float(beta[at][0]) for term, at in own if term.effect.scales]
        added = [X[:, at] @ beta[at] for term, at in own if term.effect.entry == "adds torque"]
        if not (scaling or added or any(isinstance(term, DriveTerm) for term in terms)):
            return 1.0
        whole = self.prepared.whole
        position = whole.kept(whole.row(Q)[None])[:, 0]
        travel = self._size(position - np.average(position, weights=self.weight))
        load = self.prepared.balanced_load
        if self.prepared.gain_unknown:
            load = load * float(beta[self.layout.base.index("load")])
        # a drive and a load that both hardly act would agree on any motion
        loads = self._size(load) / travel, self._size(load + sum(added)) / travel
        held = np.maximum(self.balance.answer(()), 0.0) + loads[0]
        holds = np.maximum(self.balance.answer(terms), 0.0)
        holds += max(loads[1] * math.prod(scaling), 0.0)
        least = _HARDLY * float(np.max(held))
        change = np.log(np.maximum(holds, least) / np.maximum(held, least))
        return float(np.exp(np.average(change, weights=self.weight**2)))

    def _drive(self, y: Array) -> Array:
        """The part of a target that comes from the drive, without the load if the load is known."""
        return y if self.prepared.gain_unknown else y + self.prepared.balanced_load

    def residual(self, x: Array) -> Array:
        """Weighted target minus model; the original drive if the changed drive is zero."""
        X, y, beta, _, unit = self.solved(x)
        if unit != 1.0 and not np.any(y):
            return np.asarray(self.prepared.balanced_drive * self.weight)
        out: Array = (y - X @ beta) * (self.weight * unit)
        return out

    def derivative(self, x: Array) -> Array:
        """Derivative of the residual by the searched numbers, with the coefficients refitted."""
        X, y, beta, _, unit = self.solved(x)
        w = self.weight[:, None]
        moves = self.balance.moves(*self.split(x), beta, through_terms=False) * w
        free = self.layout.with_load(X)[:, (beta > self.low) & (beta < self.high)] * w
        length = np.linalg.norm(free, axis=0)
        Q_, R = np.linalg.qr(free[:, length > 0.0] / length[length > 0.0])
        Q_ = Q_[:, np.abs(np.diag(R)) > 1e-8]
        found = unit * (Q_ @ (Q_.T @ moves) - moves)
        # of a drive that is nothing the unit is at its end, and moves with no number
        if unit != 1.0 and np.any(y):
            left, y = unit * (y - X @ beta) * self.weight, y * self.weight
            for k, term in enumerate(self.terms):
                if isinstance(term, DriveTerm):
                    at = self.layout.searched(k)
                    # these move the drive alone, whose size is in the unit
                    found[:, at] += np.outer(left, y @ moves[:, at]) / (y @ y)
        return np.asarray(found)

    def result(self, x: Array) -> Fit:
        """The fit at one point of the search."""
        X, y, beta, acting, _ = self.solved(x)
        shape, terms = self.split(x)
        gain = float(1.0 / beta[0]) if self.prepared.gain_unknown else 1.0
        moves = self.balance.moves(shape, terms, beta)
        low, high = self._ranges(shape, terms)
        near = 1e-4 * (self.bounds[1] - self.bounds[0])
        # possible free oscillations at the start of the logs
        swings = [
            swings_of(self.prepared, term) * beta[self.layout.coefficients(i)]
            for i, term in enumerate(terms)
            if term.effect.free
        ]
        return Fit(
            shape=shape,
            terms=terms,
            drive=self.prepared.drive,
            beta=beta,
            gain=gain,
            layout=layout_of(self.prepared, shape, terms),
            residual=(y - X @ beta) * gain,
            jacobian=np.column_stack([X, moves]) * gain,
            weight=self.weight,
            bound=np.concatenate(
                [
                    (beta <= self.low) | (beta >= self.high),
                    (x - self.bounds[0] <= near) | (self.bounds[1] - x <= near),
                ]
            ),
            low=np.concatenate([self.low, low - x]),
            high=np.concatenate([self.high, high - x]),
            log_index=self.prepared.log_index,
            begun=np.hstack([np.zeros((len(y), 0)), *swings]) * gain,
            target_rms=root_mean_square(self._drive(y) * gain),
            acting=acting,
            holding=self._holding(terms, X, beta),
            commanded=self.prepared.commanded,
        )


def pattern_search(
    squares: Callable[[Array], float], x: Array, axes: Sequence[int], low: Array, high: Array
) -> Array:
    """A point within bounds from which no step along these axes reduces the sum of squares.

    The sum of squares over the width of a gap, or over a threshold, is a valley with a rough floor:
    an impact shifts by a sample, a sample crosses the threshold. A gradient search stops at the
    first local minimum; steps longer than the roughness do not (Kolda, Lewis, Torczon 2003).
    """
    x, least, step = x.copy(), squares(x), 0.16
    while step > 0.002:
        moved = False
        for k in axes:
            for factor in (1.0 + step, 1.0 / (1.0 + step)):
                there = x.copy()
                there[k] = np.clip(x[k] * factor, low[k], high[k])
                found = squares(there)
                if found < least:
                    x, least, moved = there, found, True
                    break
        if not moved:
            step *= 0.5
    return x
