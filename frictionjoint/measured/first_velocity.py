"""The velocity at the first sample of a log.

A filter of the whole motion has no data before the first sample. For a joint that starts from rest
it can return several rad/s in the wrong direction, and a simulation that starts with this velocity
is wrong for a while. So the velocity is estimated from the first samples only.
"""

import numpy as np

from frictionjoint.arrays import Array


def first_velocity(time: Array, position: Array, count: float) -> float:
    """Velocity at the first sample, rad/s (m/s): 0 at rest, otherwise from a parabola.

    The parabola spans as many samples as it fits to within half a count, because rounding makes a
    velocity uncertain by about one count per duration.

    Args:
        count: encoder step, rad (m); 0: the shortest interval is used.
    """
    t, q = time - time[0], position - position[0]
    # the shortest interval, s
    least = max(3, int(np.searchsorted(t, 0.02, side="right")))
    if np.max(np.abs(q[:least])) <= 0.5 * count:
        return 0.0
    found = 0.0
    # the longest, s, applies to a joint that is almost at rest
    for n in range(least, max(least, int(np.searchsorted(t, 0.2, side="right"))) + 1):
        parabola = np.polynomial.Polynomial.fit(t[:n], q[:n], 2)
        off = float(np.max(np.abs(parabola(t[:n]) - q[:n])))
        if n > least and off > 0.5 * count:
            break
        found = float(parabola.deriv()(0.0))
    return found
