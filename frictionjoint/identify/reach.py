"""Remaining first-order reduction of a fit."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.basis import lengths, without
from frictionjoint.identify.fit import Fit


def unreached(fitted: Fit) -> Array:
    """First-order estimate of the part of each squared residual that a fit could still remove.

    A search that stops before a minimum has already tried the first-order step without success, so
    the residual of the fit is valid, not the smaller first-order value.

    Returns:
        N m^2, shape (n,).
    """
    w = fitted.weight
    left = fitted.residual * w
    free = fitted.free_jacobian * w[:, None]
    return np.asarray(left**2 - without(left, free / lengths(free)) ** 2)
