"""Temperature of a joint or motor above its reference, in logs and simulations."""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import TEMP


@compiled
def warmer(reference: float, sig: Vector, X: Vector, x: int) -> float:
    """T - T0, K; X[x] if there is no thermometer, so that a simulation can set it."""
    return X[x] if math.isnan(sig[TEMP]) else sig[TEMP] - reference
