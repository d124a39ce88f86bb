"""A linear spring before breakaway, the Stribeck curve after it.

Armstrong-Helouvry (1991), Control of Machines with Friction, the presliding part of the
seven-parameter model:

    stuck:    F = sigma0 x        until |F| reaches the breakaway torque Fs
    sliding:  F = S(v) + sigma2 v until the motion reverses

His Stribeck curve is a Lorentzian; here it is the S(v) common to all laws of this package. The
other two of the seven parameters, frictional lag and the growth of Fs with dwell time, are effects
of the catalogue (`frictional-lag`, `dwell-time`).

On reversal the contact sticks with the spring as stretched as the sliding torque has left it, so
the torque is continuous there. It jumps from Fs to S(v) at breakaway: that is the published law.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, HEADER, OWN, RATE, side, total
from frictionjoint.law.stribeck import FS, stribeck_level

SIGMA0 = OWN
SLIDING = HEADER
SIZE = HEADER + 1


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
    Fh, direction, sliding = X[a + FH], X[a + DIRECTION], X[a + SLIDING]
    if dq != 0.0:
        now = 1.0 if dq > 0.0 else -1.0
        if now != direction:
            sliding = 0.0
        direction = now
        side_ = side(p, now)
        f = now * Fh
        if sliding == 0.0:
            f += P[p + SIGMA0] * abs(dq)
            if f >= P[side_ + FS]:
                sliding = 1.0
        if sliding == 1.0:
            f = stribeck_level(P, side_, abs(dq) / dt if dt > 0.0 else 0.0)
        Fh = now * f
    X[h + FH] = Fh
    X[h + RATE] = 1.0 - sliding
    X[h + DIRECTION] = direction
    X[h + SLIDING] = sliding
    return total(P, p, Fh, 1.0 - sliding, v)
