"""Temperature of a joint or motor above its reference, in logs and simulations."""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import TEMP


@compiled
def warmer(reference: float, sig: Vector, X: Vector, x: int) -> float:
    """T - T0, K; X[x] if there is no thermometer, so that a simulation can set it."""
    return X[x] if math.isnan(sig[TEMP]) else sig[TEMP] - reference


def usual(signals: Array) -> float:
    """Mean temperature of logs, deg C: what is fitted without an effect of it applies there."""
    return float(np.nanmean(signals[:, TEMP]))
