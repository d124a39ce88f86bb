"""The least of a rough function: a search in finite steps along each axis (compass search).

Squares over the width of a gap, or over a threshold, are a valley with a rough floor: an impact
comes a sample later, a sample passes to the other side. A derivative follows the roughness and
ends in the first dent; steps that are longer than the dents do not (Kolda, Lewis, Torczon 2003).
"""

from collections.abc import Callable, Sequence

import numpy as np

from frictionjoint.arrays import Array

# the first steps and the last ones, over the numbers
_FIRST, _LAST = 0.16, 0.002


def compass(
    squares: Callable[[Array], float], x: Array, axes: Sequence[int], low: Array, high: Array
) -> Array:
    """A point from which no step along these axes leads to less, shape (p,).

    Args:
        squares: to make small. x: where to begin, shape (p,). axes: that may move.
        low, high: ends of the range, shape (p,).
    """
    x, least, step = x.copy(), squares(x), _FIRST
    while step > _LAST:
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
