"""What the rival laws have in common: the layout of their parameters and of their state.

Parameters ``P[p:]``: presliding damping sigma1, then Fs, Fc, Vs, delta, sigma2 for motion in the
positive and in the negative direction (see `stribeck`; a law without Stribeck effect repeats
Fs = Fc), then the law's own numbers from ``P[p + OWN]`` on.

State header ``X[h:]``: hysteresis torque Fh in N m, dz/dx at the end of the last step, sign of the
last nonzero displacement, then whatever the law needs. No law here keeps stacks, so committing a
step is copying one header over the other.

As in the integrated law, the state is the torque Fh = sigma0 z and one step is one displacement
at one speed, hence one level S; it is written for motion in the positive direction (`f`, the
mirrored torque) and solved exactly in displacement.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line
from frictionjoint.law.stribeck import SIGMA2

FH, RATE, DIRECTION = range(3)
HEADER = DIRECTION + 1

SIGMA1, POSITIVE = range(2)
NEGATIVE = POSITIVE + 5
OWN = NEGATIVE + 5


@in_line
def side(p: int, direction: float) -> int:
    """Index of the first level for a direction."""
    return p + POSITIVE if direction > 0.0 else p + NEGATIVE


@in_line
def total(P: Vector, p: int, Fh: float, rate: float, v: float) -> float:
    """F = Fh + sigma1 dz/dt + sigma2 v."""
    sigma2 = P[p + POSITIVE + SIGMA2] if v > 0.0 else P[p + NEGATIVE + SIGMA2]
    return Fh + (P[p] * rate + sigma2) * v
