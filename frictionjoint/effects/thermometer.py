"""How much warmer than its reference a joint or motor is, of a log or of a simulation."""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import TEMP


@compiled
def warmer(reference: float, sig: Vector, X: Vector, x: int) -> float:
    """T - T0, K; X[x] where no thermometer is read, so that a simulation can set it."""
    return X[x] if math.isnan(sig[TEMP]) else sig[TEMP] - reference
