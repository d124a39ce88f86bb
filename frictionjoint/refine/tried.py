"""Least-squares fit to simulated motion, and its held-out evidence.

Windows come first: short runs from the measured motion are smooth in the parameters. A whole log is
not, because a joint that sticks once too early stays at another position for the rest of it. Whole
logs come last, because they are what a user will simulate.
"""

from collections.abc import Sequence
from functools import cached_property, partial

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.refine.guard import (
    Mask,
    kinds,
    missing_width,
    of_logs,
    spread,
    uncertain,
    without_each,
)
from frictionjoint.refine.objective import MOST_STEPS, Objective, Secant
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course


class Tried:
    """Fitted numbers and their evidence, computed when first needed.

    Attributes:
        vector, values: the numbers, shape (p,).
    """

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
    """Search the numbers of a model with the smallest position error.

    Args:
        window_s: s between restarts from the measured motion; None: whole logs.
        starts: numbers to start from.
    """
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
