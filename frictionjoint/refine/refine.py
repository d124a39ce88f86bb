"""Least squares on simulated motion, from the balance fit, and the guard around it.

Windows come first: short runs from the measured motion are smooth in the parameters where a whole
log is not, for a joint that sticks once too early is somewhere else for the rest of it. Whole logs
come last, for they are what is judged.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.diagnose.closed_loop import Course
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.guard import (
    balanced_without_each,
    clearly_less,
    kinds,
    missing_width,
    of_logs,
    on_each,
    spread,
    without_each,
)
from frictionjoint.refine.motion import WINDOW_S
from frictionjoint.refine.objective import Objective
from frictionjoint.refine.secant import Secant
from frictionjoint.refine.vector import Vector

# steps of each round of a stage, rounds, and the fraction of the squares that one must take away
_MOST, _ROUNDS, _ENOUGH = 10, 4, 2e-2
# squares of a start over those of the nearest one, up to which it is searched from too
_AS_NEAR = 1.25


@dataclass(frozen=True)
class Refined:
    """Outcome of a refinement.

    Attributes:
        fit: refined, or the balance's own where it does not clearly predict unlike motion better.
        taken: whether it is the refined one. names: of the numbers in `values`.
        values, cov: of the refined numbers, shapes (p,) and (p, p); see `vector.Vector`.
        left_out: mean absolute error of each log, see `guard.of_logs`, by what was fitted to other
            kinds of logs, before and after, shape (logs,) each, rad (m).
        near: the same of the refined numbers in windows from the measured motion, shape (logs,).
    """

    fit: Fit
    taken: bool
    values: Array
    cov: Array
    left_out: tuple[Array, Array]
    near: Array
    vector: Vector

    @property
    def stands(self) -> Array:
        """`left_out` of the outcome."""
        before, after = self.left_out
        return after if self.taken else before

    @property
    def gain_error(self) -> float:
        """Standard error of the gain of the drive over the gain; 0 where it is known."""
        return float(np.sqrt(self.cov[0, 0])) if self.vector.has_gain else 0.0

    @property
    def guard(self) -> tuple[float, float]:
        """Means of `left_out`."""
        before, after = self.left_out
        return float(np.mean(before)), float(np.mean(after))


def refine(
    prepared: Prepared,
    fitted: Fit,
    cov: Array,
    courses: Sequence[Course],
    progress: Callable[[str], None] = lambda text: None,
    begin: Callable[[Vector], list[Array]] | None = None,
) -> Refined:
    """Refine all numbers of a fitted model by the motion of its logs.

    Args:
        cov: of the fit's parameters, in the order of its jacobian. courses: of the logs it was
            fitted to. begin: numbers to begin with on whole logs, wherever they are near; None: the
            fit's own, by way of windows.
    """
    vector = Vector(prepared, fitted, cov, courses[0].run.load.armature)
    windows = Objective(vector, courses, WINDOW_S, vector.start)
    if begin:
        starts = begin(vector)
    else:
        progress(f"refine: windows of {WINDOW_S:g} s, {1e3 * windows.size:.3g} mrad")
        starts = [_search(windows, vector.start)[0]]
    objective = Objective(vector, courses, None, starts[0])
    progress(f"refine: whole logs, {1e3 * objective.size:.3g} mrad")
    costs = [_cost(objective, start) for start in starts]
    some = [x for x, cost in zip(starts, costs, strict=True) if cost <= _AS_NEAR * min(costs)]
    x, J = min([_search(objective, x) for x in some], key=lambda end: _cost(objective, end[0]))
    progress("refine: guard")
    masks = kinds(courses)
    before = of_logs(balanced_without_each(prepared, fitted, courses, masks), courses)
    z = objective.units(x)
    moved, errors = without_each(objective, z, J, masks)
    after = of_logs(errors, courses)
    near = of_logs(on_each(windows, moved, masks), courses)
    uncertain = np.linalg.pinv(J.T @ J) + spread(z, moved, masks)
    uncertain *= missing_width(objective, z, uncertain, errors) ** 2
    uncertain *= np.outer(vector.unit, vector.unit)
    taken = clearly_less(after, before)
    refined = vector.fit(x) if taken else fitted
    return Refined(refined, taken, x, np.asarray(uncertain), (before, after), near, vector)


def _cost(objective: Objective, x: Array) -> float:
    return float(np.sum(objective(objective.units(x)) ** 2))


def _search(objective: Objective, x: Array) -> tuple[Array, Array]:
    """Numbers at the least squares nearby, and the derivatives there in units of the prior.

    A search on derivatives that its steps keep up to date may end early: it begins again with new
    ones until that brings nothing.
    """
    bounds = objective.bounds
    z = np.clip(objective.units(x), *bounds)
    cost = np.inf
    for _ in range(_ROUNDS):
        found = least_squares(
            objective, z, jac=Secant(objective, bounds), bounds=bounds, max_nfev=_MOST,
            ftol=1e-3, xtol=1e-3,
        )  # fmt: skip
        z, before, cost = found.x, cost, found.cost
        if before - cost < _ENOUGH * cost:
            break
    return objective.numbers(z), np.asarray(found.jac)
