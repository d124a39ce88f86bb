"""Dahl's hysteresis scaled by the Stribeck curve.

    F     = S(v) z + sigma2 v
    dz/dx = sigma0 / Fs |1 - z sgn(v)|**i sgn(1 - z sgn(v))

With Fs = Fc it is Dahl's law (see `dahl`). Where the other laws with a Stribeck effect follow the
sliding level over a displacement, here the level follows the speed at once, before sliding too: a
friction curve over velocity that has been given a presliding, as many simulations have it. The side
of the torque says whose level it is, so that the torque is continuous where the motion reverses.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, HEADER, OWN, RATE, side, total
from frictionjoint.law.dahl import remaining
from frictionjoint.law.stribeck import FS, stribeck_level

SIGMA0, EXPONENT = OWN, OWN + 1
Z = HEADER
SIZE = HEADER + 1


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
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
