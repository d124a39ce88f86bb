"""Dahl's law: Dahl (1968), A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1.

    dF/dx = sigma0 |1 - F/Fc sgn(v)|**i sgn(1 - F/Fc sgn(v))

With w = 1 - F/Fc and a = sigma0 dx / Fc it reads dw/da = -w**i, solved in closed form for every
i >= 0: i = 0 is a linear spring with a limit, i < 1 reaches Fc after a finite displacement, i = 1
is the usual exponential, i > 1 approaches Fc algebraically. There is no Stribeck effect; sigma2 v
is added as everywhere in this package and zero in Dahl's report.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, HEADER, OWN, RATE, side, total
from frictionjoint.law.stribeck import FC, FS, stribeck_level

SIGMA0, EXPONENT = OWN, OWN + 1
# state behind the header of `stribeck_step`, and its size with this
Z, STRIBECK_SIZE = HEADER, HEADER + 1


@compiled
def remaining(w: float, a: float, i: float) -> float:
    """Solution of dw/da = -w**i after a >= 0, from w >= 0."""
    if w <= 0.0 or a == 0.0:
        return max(w, 0.0)
    if i == 0.0:
        return max(0.0, w - a)
    if i == 1.0:
        return w * math.exp(-a)
    e = 1.0 - i
    # w**(1-i) - (1-i) a, relative to w: keeps its digits as i goes to 1
    used = e * a * math.exp(-e * math.log(w)) if -e * math.log(w) < 700.0 else e * math.inf
    if used >= 1.0:
        return 0.0
    return w * math.exp(math.log1p(-used) / e)


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
    Fh, rate, direction = X[a + FH], X[a + RATE], X[a + DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        Fc = P[side(p, direction) + FC]
        i = P[p + EXPONENT]
        w = remaining(1.0 - direction * Fh / Fc, P[p + SIGMA0] * abs(dq) / Fc, i)
        Fh = direction * Fc * (1.0 - w)
        rate = w**i if w > 0.0 else 0.0
    X[h + FH] = Fh
    X[h + RATE] = rate
    X[h + DIRECTION] = direction
    return total(P, p, Fh, rate, v)


@compiled
def stribeck_step(
    P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float
) -> float:
    """`step` with the hysteresis scaled by the Stribeck curve.

        F     = S(v) z + sigma2 v
        dz/dx = sigma0 / Fs |1 - z sgn(v)|**i sgn(1 - z sgn(v))

    With Fs = Fc it is Dahl's law. Where the other laws with a Stribeck effect follow the sliding
    level over a displacement, here the level follows the speed at once, before sliding too: a
    friction curve over velocity that has been given a presliding, as many simulations have it. The
    side of the torque says whose level it is, so that the torque is continuous where the motion
    reverses.
    """
    z, rate, direction = X[a + Z], X[a + RATE], X[a + DIRECTION]
    dx = abs(dq)
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        Fs = P[side(p, direction) + FS]
        i = P[p + EXPONENT]
        w = remaining(1.0 - direction * z, P[p + SIGMA0] * dx / Fs, i)
        z = direction * (1.0 - w)
        rate = w**i if w > 0.0 else 0.0
    Fh = z * stribeck_level(P, side(p, z), dx / dt if dt > 0.0 else 0.0)
    X[h + FH] = Fh
    X[h + RATE] = rate
    X[h + DIRECTION] = direction
    X[h + Z] = z
    return total(P, p, Fh, rate, v)
