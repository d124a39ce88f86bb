"""Derivatives of simulated motion: by differences at first, then updated by each step.

Each step shows how the errors change along it, at the cost of one simulation; Broyden's update
(1965) puts that into the derivatives and leaves all other directions unchanged. If they do not
predict a step, differences are computed again. New ones need not be better: at the boundary between
sticking and sliding, a small difference misses the effect of a step.
"""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array


class Secant:
    """Jacobian for a search, called at each accepted point.

    Args:
        residual: of the search. bounds: of the numbers. last: a point with its residual and
            derivatives, if known. again: whether differences are computed again; else known
            derivatives stay in use.
    Attributes:
        last: the point of the last call. new: whether its derivatives are differences.
    """

    def __init__(
        self,
        residual: Callable[[Array], Array],
        bounds: tuple[Array, Array],
        last: tuple[Array, Array, Array] | None,
        again: bool = True,
    ) -> None:
        self.residual, self.bounds, self.last, self.again = residual, bounds, last, again
        self.new = False

    def __call__(self, z: Array) -> Array:
        """Shape (n, p)."""
        r = self.residual(z)
        J = self._updated(z, r)
        self.new = J is None
        if J is None:
            J = differences(self.residual, self.bounds, z, r)
        self.last = z.copy(), r, J
        return J

    def _updated(self, z: Array, r: Array) -> Array | None:
        if self.last is None:
            return None
        z0, r0, J0 = self.last
        step = z - z0
        change = r - r0
        missed = change - J0 @ step
        if not step.any():
            return J0
        if self.again and np.linalg.norm(missed) > np.linalg.norm(change):
            return None
        return np.asarray(J0 + np.outer(missed, step / (step @ step)))


def differences(
    residual: Callable[[Array], Array], bounds: tuple[Array, Array], z: Array, r: Array
) -> Array:
    """Derivatives of a residual, which is r at z, by differences within bounds, shape (n, p)."""
    columns, step = [], 0.02
    for i in range(len(z)):
        h = step if z[i] + step <= bounds[1][i] else -step
        moved = z.copy()
        moved[i] += h
        columns.append((residual(moved) - r) / h)
    return np.column_stack(columns)
