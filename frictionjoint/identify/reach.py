"""Remaining first-order reduction of a fit."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.basis import without
from frictionjoint.identify.design import lengths
from frictionjoint.identify.fit import Fit


def unreached(fitted: Fit) -> Array:
    """Part of each squared residual that would vanish to first order, N m^2, (n,).

    A search that stops before a minimum has tried that step without success: the residual is what
    the fit leaves, not what first order promises.
    """
    w = fitted.weight
    left = fitted.residual * w
    free = fitted.free_jacobian * w[:, None]
    return np.asarray(left**2 - without(left, free / lengths(free)) ** 2)
