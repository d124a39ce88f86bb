"""Hand-written tangents for functions whose source does not show their derivative.

Some kernels take a short cut at a particular parameter value (an exponent of 1, equal levels), and
there their source lacks the terms that the derivative requires. An iterative solution is
differentiated through the equation that its result solves, not through its iterations. These
functions replace the kernels of the same name. Each number that has a tangent is followed by its
tangent in the arguments. They return the value, equal to the kernel's to the last bit, and its
tangent.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import dahl, relaxation
from frictionjoint.law.stribeck import DELTA, FC, FS, VS, ZERO
from frictionjoint.law.tangents.direction import ZERO as STILL
from frictionjoint.law.tangents.direction import Tangent, at, scaled, sum2


@in_line
def stribeck_level(
    P: Vector, P_t: Vector, d: int, speed: float, speed_t: Tangent
) -> tuple[float, Tangent]:
    """Stribeck level |S(v)| and its tangent."""
    if speed == 0.0:
        return P[d + FS], at(P_t, d + FS)
    Fs = P[d + FS]
    Fc = P[d + FC]
    ratio = speed / P[d + VS]
    delta = P[d + DELTA]
    x = ratio
    if delta == 2.0:
        x = ratio * ratio
    elif delta != 1.0:
        x = ratio**delta
    if x > ZERO:
        return Fc, at(P_t, d + FC)
    e = math.exp(-x)
    fall = (Fs - Fc) * e * x
    by_levels = sum2(e, at(P_t, d + FS), 1.0 - e, at(P_t, d + FC))
    by_ratio = sum2(fall * delta / P[d + VS], at(P_t, d + VS), -fall * delta / speed, speed_t)
    by_delta = -fall * math.log(ratio) if fall > 0.0 else 0.0
    S_t = sum2(1.0, sum2(1.0, by_levels, 1.0, by_ratio), by_delta, at(P_t, d + DELTA))
    return Fc + (Fs - Fc) * e, S_t


@in_line
def rate(r: float, r_t: Tangent, n: float) -> tuple[float, Tangent]:
    """1 - sgn(r) |r|**n and its tangent; the exponent n has none."""
    slope = n if n == 1.0 else n * relaxation.power(abs(r), n - 1.0)
    return relaxation.rate(r, n), scaled(-slope, r_t)


@in_line
def advance(r: float, r_t: Tangent, a: float, a_t: Tangent, n: float) -> tuple[float, Tangent]:
    """Solution of dr/da = rate(r) after a displacement a from r, and its tangent."""
    end = relaxation.advance(r, a, n)
    at_end = relaxation.rate(end, n)
    # Nearer to r = 1 than the square root of the spacing of doubles rounding destroys the ratio of
    # the rates, and the flow is linear to the same accuracy.
    kept = at_end / relaxation.rate(r, n) if abs(1.0 - r) > 1.5e-8 else math.exp(-n * a)
    return end, sum2(kept, r_t, at_end, a_t)


@in_line
def distance(r0: float, r0_t: Tangent, r1: float, r1_t: Tangent, n: float) -> tuple[float, Tangent]:
    """Inverse of `advance`: the integral of 1 / rate, and its tangent, zero if it is infinite."""
    a = relaxation.distance(r0, r1, n)
    if a == math.inf:
        return a, STILL
    return a, sum2(1.0 / relaxation.rate(r1, n), r1_t, -1.0 / relaxation.rate(r0, n), r0_t)


@compiled
def remaining(
    w: float, w_t: Tangent, a: float, a_t: Tangent, i: float, i_t: Tangent
) -> tuple[float, Tangent]:
    """Solution of Dahl's dw/da = -w**i after a displacement a, and its tangent.

    The solution is w1**e = w**e - e a with e = 1 - i; the formulas also hold for e = 0.
    """
    end = dahl.remaining(w, a, i)
    if end <= 0.0:
        return end, STILL
    e = 1.0 - i
    log_w = math.log(w)
    y = a * math.exp(-e * log_w)
    x = e * y
    # (log(1 - x) + x / (1 - x)) / e**2; its terms cancel at small x, so a series replaces it there
    if abs(x) < 0.02:
        second = y * y * (0.5 + x * (2 / 3 + x * (3 / 4 + x * (4 / 5 + x * (5 / 6 + x * 6 / 7)))))
    else:
        second = (math.log1p(-x) + x / (1.0 - x)) / (e * e)
    by_i = end * (second - log_w * y / (1.0 - x))
    rate_ = end**i
    return end, sum2(1.0, sum2((end / w) ** i, w_t, -rate_, a_t), by_i, i_t)
