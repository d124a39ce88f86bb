"""The velocity with which a log begins.

A filter of the whole motion has nothing before the first sample and makes something up: of a joint
that stands and is sent off, a velocity of several rad/s the other way. A simulation that begins
with it is elsewhere for a while. So it is read from the first samples alone.
"""

import numpy as np

from frictionjoint.arrays import Array

# s: samples of the least stretch, and of the longest one, which is at rest or nearly so
_LEAST, _LONGEST = 0.02, 0.2


def first_velocity(time: Array, position: Array, count: float) -> float:
    """rad/s (m/s) at the first sample: none where the joint stands, else of a parabola.

    Through as many samples as it follows to within half a count: rounding makes a velocity
    uncertain by about a count over the length of the stretch.

    Args:
        count: step of the position, rad (m); 0: the least stretch is taken.
    """
    t, q = time - time[0], position - position[0]
    least = max(3, int(np.searchsorted(t, _LEAST, side="right")))
    if np.max(np.abs(q[:least])) <= 0.5 * count:
        return 0.0
    found = 0.0
    for n in range(least, max(least, int(np.searchsorted(t, _LONGEST, side="right"))) + 1):
        parabola = np.polynomial.Polynomial.fit(t[:n], q[:n], 2)
        off = float(np.max(np.abs(parabola(t[:n]) - q[:n])))
        if n > least and off > 0.5 * count:
            break
        found = float(parabola.deriv()(0.0))
    return found
