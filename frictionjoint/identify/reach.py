"""How near a fit has come to its minimum."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.basis import without
from frictionjoint.identify.design import lengths
from frictionjoint.identify.fit import Fit


def unreached(fitted: Fit) -> Array:
    """What a fit leaves of each sample's square where to first order it need not, N m^2, (n,).

    A search that stops short of a minimum has tried the step there, and it did not hold: the
    squares are what the fit leaves, not what it promises.
    """
    w = fitted.weight
    left = fitted.residual * w
    free = fitted.free_jacobian * w[:, None]
    return np.asarray(left**2 - without(left, free / lengths(free)) ** 2)
