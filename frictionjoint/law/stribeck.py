"""The sliding level S(v) of equation (6) in Ganseman et al. (1997), one direction at a time.

The paper writes S(v) without sgn(v); for v < 0 every symbol takes its negative-direction value.
Here the level of a direction is a positive magnitude, and the caller applies the sign.
A direction occupies ``P[d:d+5]``: Fs, Fc, Vs, delta, sigma2.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line

FS, FC, VS, DELTA, SIGMA2 = range(5)
# exp(-x) is zero to the last bit from here on, which takes the library long to find out
ZERO = 746.0


@in_line
def stribeck_level(P: Vector, d: int, speed: float) -> float:
    """|S(v)| = Fc + (Fs - Fc) exp(-(|v|/Vs)**delta) of the direction stored at d, in N m."""
    Fs = P[d + FS]
    Fc = P[d + FC]
    if Fs == Fc or speed == 0.0:
        return Fs
    x = speed / P[d + VS]
    delta = P[d + DELTA]
    # a power costs more than the rest of a sliding step; these two exponents are the usual ones
    if delta == 2.0:
        x = x * x
    elif delta != 1.0:
        x = x**delta
    if x < 1e-5:  # three terms of the series
        return Fs - (Fs - Fc) * (x - 0.5 * x * x)
    # beyond 50 it is lost in rounding next to any Coulomb torque that is not tiny
    if x > ZERO or (x > 50.0 and Fc > 1e-5 * Fs):
        return Fc
    return Fc + (Fs - Fc) * math.exp(-x)
