"""How a change of the friction level reaches the torque: by motion, not by time.

The level limits the torque of a stuck contact; it does not move the contact. While the joint is at
rest the torque stays constant when the level changes. When the joint moves, the torque follows the
level over the presliding distance. To first order in the change this is what LuGre's bristle does:
with dz/dx = 1 - sigma0 z/S, a level S + s adds the torque E with dE/d|x| = (s h - E) sigma0/S,
where h = sigma0 z/S.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Shape
from frictionjoint.effects.signals import DT, ONSET, SHARE, Q

# lengths over which a change of the level is reached, over the travel, where a fit starts
REACHES = (1e-4, 1e-3)


@compiled
def within_one(h: float) -> float:
    """Fh/Fc without its Stribeck part, within +-1."""
    return min(1.0, max(-1.0, h))


@compiled
def reached(
    start: float, level: float, h: float, reach: float, sig: Vector, X: Vector, x: int
) -> float:
    """Torque of a level s, approached over `reach` of motion (0: immediately).

    Along a log E approaches s h. In a simulation that E would lag behind h in each vibration and
    return more work than it takes: a joint at rest would creep. There a level above zero is a
    bristle of its own (Dahl, 1968), which only dissipates.

    Args:
        start: the level at the first sample. h: Fh/Fc, or within +-1. X[x]: E; X[x+1]: last
            position.
    """
    target, dq = level * h, sig[Q] - X[x + 1]
    if sig[ONSET] > 0.0 and level > 0.0:
        reach += sig[ONSET]
        sig[SHARE] = sig[ONSET] / reach
        target = level * max(1.0, abs(h))
        if dq < 0.0:
            target = -target
    if sig[DT] <= 0.0:
        X[x] = start * h
    elif reach > 0.0:
        X[x] = X[x] - (target - X[x]) * math.expm1(-abs(dq) / reach)
    elif dq != 0.0:
        X[x] = target
    X[x + 1] = sig[Q]
    return X[x]


def reaches(signals: Array) -> list[Shape]:
    """Initial lengths, relative to the travel of a log."""
    span = float(np.ptp(signals[:, Q]))
    return [(part * span,) for part in REACHES if span > 0.0]
