"""Derivatives of simulated motion: by differences at first, then kept up to date by each step.

A step tells how the errors change along it, which one simulation has already found; Broyden's
update (1965) puts that into the derivatives and leaves all other directions as they are. Where they
tell nothing of a step, differences are taken again. New ones need not be better than those kept:
where a joint sticks or not, a small difference sees little of what a step makes.
"""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array

# units of the prior by which a number is moved for a difference
_STEP = 0.02


class Secant:
    """Jacobian for a search, called at each point that it goes on from.

    Args:
        residual: of the search. bounds: within which a number is moved. last: a point with its
            residual and derivatives, where they are known. again: whether differences are taken
            again; else the derivatives known stay in use.
    Attributes:
        last: the point of the last call. new: whether its derivatives are differences.
    """

    def __init__(
        self,
        residual: Callable[[Array], Array],
        bounds: tuple[Array, Array],
        last: tuple[Array, Array, Array] | None = None,
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
    columns = []
    for i in range(len(z)):
        h = _STEP if z[i] + _STEP <= bounds[1][i] else -_STEP
        moved = z.copy()
        moved[i] += h
        columns.append((residual(moved) - r) / h)
    return np.column_stack(columns)
