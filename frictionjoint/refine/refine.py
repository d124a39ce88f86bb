"""Least squares on simulated motion, starting from the torque fit, and the decision to use it.

Windows come first: short runs from the measured motion are smooth in the parameters. A whole log is
not, because a joint that sticks once too early stays at another position for the rest of it. Whole
logs come last, because they are what a user will simulate.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import Estimate, law_estimates, term_estimates
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.guard import (
    Mask,
    balanced_without_each,
    gains,
    kinds,
    missing_width,
    of_logs,
    spread,
    uncertain,
    without_each,
)
from frictionjoint.refine.objective import LONGEST_WINDOW_S, MOST_STEPS, Objective, Secant, errors
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course, LoopErrors, Loops

# a law's number by which its level falls with the speed, Fs / Fc - 1
_FALL = "excess"


class Tried:
    """Fitted numbers, `values` of a `vector`, shape (p,), and their evidence when first needed."""

    def __init__(self, vector: Vector, objective: Objective, values: Array, J: Array) -> None:
        self.vector, self.values = vector, values
        self._objective = objective
        self._z, self._J = objective.units(values), J

    @cached_property
    def masks(self) -> list[Mask]:
        """Samples to leave out together, one mask per kind of motion."""
        return kinds(self._objective.courses)

    @cached_property
    def _without(self) -> tuple[Array, Array]:
        return without_each(self._objective, self._z, self._J, self.masks)

    @cached_property
    def left_out(self) -> Array:
        """Error of each log, of the model fitted to other kinds, rad (m), shape (logs,)."""
        return of_logs(self._without[1], self._objective.courses)

    @cached_property
    def fitted(self) -> Array:
        """Error of each log, of the model fitted to all of them, rad (m), shape (logs,)."""
        found = self._objective.errors_of(self.vector.fit(self.values))
        return np.array([np.mean(np.abs(e)) for e in found])

    @cached_property
    def cov(self) -> Array:
        """Covariance of the numbers, shape (p, p)."""
        moved, errors = self._without
        of_logs = self._J[: -len(self._z)]  # the last rows are the prior
        cov = partial(uncertain, of_logs.T @ of_logs, spread(self._z, moved, self.masks))
        wider = missing_width(self._objective, self._z, cov, errors)
        return np.asarray(cov(wider) * np.outer(self.vector.unit, self.vector.unit))


def tried(
    vector: Vector, courses: Sequence[Course], window_s: float | None, starts: Sequence[Array]
) -> Tried:
    """Search the numbers of a model with the smallest position error from some starts, with
    `window_s` s between restarts from the measured motion; None: whole logs."""
    objective = Objective(vector, courses, window_s, starts[0])
    costs = [_cost(objective, start) for start in starts]
    # starts nearly as good as the best one
    some = [x for x, cost in zip(starts, costs, strict=True) if cost <= 1.25 * min(costs)]
    x, J = min([_search(objective, x) for x in some], key=lambda end: _cost(objective, end[0]))
    return Tried(vector, objective, x, J)


def _cost(objective: Objective, x: Array) -> float:
    return float(np.sum(objective(objective.units(x)) ** 2))


def _search(objective: Objective, x: Array) -> tuple[Array, Array]:
    """Numbers at the nearest least squares, and the derivatives there in units of the prior.

    A search with updated derivatives may end early; it is restarted with new differences until they
    bring less than 2%.
    """
    bounds = objective.bounds
    z = np.clip(objective.units(x), *bounds)
    cost = 0.5 * float(np.sum(objective(z) ** 2))
    known = None
    for _ in range(4):
        secant = Secant(objective, bounds, known)
        found = least_squares(
            objective, z, jac=secant, bounds=bounds, max_nfev=MOST_STEPS, ftol=1e-3, xtol=1e-3
        )
        z, before, cost = found.x, cost, found.cost
        if before - cost < 2e-2 * cost:
            break
        known = secant.last if secant.new else None
    return objective.numbers(z), np.asarray(found.jac)


@dataclass(frozen=True)
class Refined:
    """A refinement, and the decision to use it."""

    near: Tried  # numbers refined on windows of the logs, and their evidence
    found: Tried  # numbers refined on whole logs, and their evidence
    # mean absolute error of each log, see `guard.of_logs`, of models fitted to the torque of other
    # kinds of logs, rad (m), shape (logs,); `found.left_out` is that of the refined ones
    before: Array
    taken: bool  # whether the refined model is used, because it predicts unlike motion better

    @property
    def fit(self) -> Fit:
        """The refined model, or the torque fit if that is kept."""
        vector = self.found.vector
        return vector.fit(self.found.values) if self.taken else vector.fitted

    @property
    def left_out(self) -> Array:
        """Error of each log of the model that was selected, fitted to other kinds of logs."""
        return self.found.left_out if self.taken else self.before

    @property
    def gain_error(self) -> float:
        """Relative standard error of the drive's gain; 0 if it is known."""
        return float(np.sqrt(self.found.cov[0, 0])) if self.found.vector.has_gain else 0.0


def refine(
    prepared: Prepared,
    fitted: Fit,
    courses: Sequence[Course],
    progress: Callable[[str], None] = lambda text: None,
) -> Refined:
    """Refine all numbers of a fitted model by the motion of the logs that it was fitted to."""
    cov = stated_covariance(prepared, fitted)
    begins = [fitted, *without_stribeck(prepared, fitted)]
    armature = courses[0].run.load.armature
    progress(f"refining by simulation of {LONGEST_WINDOW_S:g} s")
    vectors = [Vector(prepared, fitted, cov, armature, each) for each in begins]
    tries = [on_windows(v, courses, [v.start]) for v in vectors]

    def error(model: Tried) -> float:
        whole = errors(courses, model.vector.fit(model.values), None)
        return float(np.mean(np.abs(np.concatenate(whole))))

    near = min(tries, key=error)
    progress("refining by simulation of whole logs")
    found = on_whole_logs(near, courses)
    progress("checking the refinement on logs left out")
    return judged(prepared, near, found, courses)


def on_windows(vector: Vector, courses: Sequence[Course], starts: Sequence[Array]) -> Tried:
    """A model refined on windows of the logs."""
    return tried(vector, courses, LONGEST_WINDOW_S, starts)


def on_whole_logs(near: Tried, courses: Sequence[Course]) -> Tried:
    """The same model refined on whole logs; itself where a measured drive allows windows only."""
    if courses[0].window_s is not None:
        return near
    return tried(near.vector, courses, None, [near.values])


def without_stribeck(prepared: Prepared, fitted: Fit) -> list[Fit]:
    """A fit whose friction level does not decrease with speed; none if the given fit is such a fit.

    A torque fit can use this decrease to absorb any other error, at speeds where friction does not
    decrease, and a local search cannot leave that minimum.
    """
    shape = fitted.shape
    numbers = dict(zip(shape.variables, shape.vector(), strict=True))
    flat = {name: 0.0 if name.startswith(_FALL) else x for name, x in numbers.items()}
    if flat == numbers:
        return []
    level = shape.moved(np.array(list(flat.values())))
    return [refit(prepared, fitted.terms, level, ROUGH, 1)]


def judged(prepared: Prepared, near: Tried, found: Tried, courses: Sequence[Course]) -> Refined:
    """Refined numbers compared with the torque fit they started from."""
    left = balanced_without_each(prepared, found.vector.fitted, courses, found.masks)
    before = of_logs(left, courses)
    taken = bool(np.mean(gains(found.left_out, before)) > 0.0)
    return Refined(near, found, before, taken)


@dataclass(frozen=True)
class RefinedModel:
    """A refinement in a report."""

    taken: bool  # whether it is the result: left-out logs are predicted better than by the fit
    guard: tuple[float, float]  # mean absolute errors on left-out logs, before and after, rad (m)
    loops: LoopErrors | None  # whole logs in closed loop; None if the drive was measured
    parameters: dict[str, Estimate]  # by name, with standard errors

    @classmethod
    def of(cls, outcome: Refined, loops: Loops | None, slide: bool, scaled: bool) -> "RefinedModel":
        """From a refinement, used or not; in units of the drive unless its gain is determined."""
        numbers = outcome.found
        whole = numbers.vector.fit(numbers.values)
        cov = numbers.vector.own_covariance(whole, numbers.cov)
        fitted = whole if scaled else without_scale(whole)
        found = law_estimates(fitted, cov, slide)
        for i, term in enumerate(fitted.effects):
            found |= {
                f"{term.name} {name}": x
                for name, x in term_estimates(fitted, cov, i, slide).items()
            }
        errors = loops.errors([whole])[0] if loops else None
        guard = float(np.mean(outcome.before)), float(np.mean(numbers.left_out))
        return cls(outcome.taken, guard, errors, found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "taken": self.taken,
            "left_out_mae": {"before": self.guard[0], "after": self.guard[1]},
            **(self.loops.figures() if self.loops else {}),
            "parameters": self.parameters,
        }
