"""Pattern search: minimum of a rough function by finite steps along each axis.

The sum of squares over the width of a gap, or over a threshold, is a valley with a rough floor: an
impact shifts by a sample, a sample crosses the threshold. A gradient search stops at the first
local minimum; steps longer than the roughness do not (Kolda, Lewis, Torczon 2003).
"""

from collections.abc import Callable, Sequence

import numpy as np

from frictionjoint.arrays import Array


def pattern_search(
    squares: Callable[[Array], float], x: Array, axes: Sequence[int], low: Array, high: Array
) -> Array:
    """A point within bounds from which no step along these axes reduces the sum of squares."""
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
