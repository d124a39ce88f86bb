"""LuGre: Canudas de Wit, Olsson, Astrom and Lischinsky (1995), IEEE Trans. Automatic Control 40(3),
equations 1 to 3.

    F     = sigma0 z + sigma1 dz/dt + sigma2 v
    dz/dt = v - sigma0 |v| / S(v) z

Linear in z at constant speed, hence an exponential in displacement of length S / sigma0.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, OWN, RATE, side, total
from frictionjoint.law.stribeck import stribeck_level

SIGMA0 = OWN


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
    Fh, rate, direction = X[a + FH], X[a + RATE], X[a + DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        dx = abs(dq)
        S = stribeck_level(P, side(p, direction), dx / dt if dt > 0.0 else 0.0)
        f = direction * Fh
        # The part still missing and the part gained apart: neither loses its digits.
        f -= (S - f) * math.expm1(-P[p + SIGMA0] * dx / S)
        Fh = direction * f
        rate = 1.0 - f / S
    X[h + FH] = Fh
    X[h + RATE] = rate
    X[h + DIRECTION] = direction
    return total(P, p, Fh, rate, v)
