"""heating: the joint's temperature in a simulation, raised by the friction loss.

It adds no torque. In a log the temperature is measured; in a simulation this effect computes it
for the effects that depend on it, which look it up here.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import DT, LOSS, TEMP


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Zero; sets sig[TEMP] to the temperature.

    X[x] is the temperature above ambient, K: C dT/dt = loss - T/R, exact for a constant loss.
    """
    if sig[DT] > 0.0:
        warmest = P[e + 1] * sig[LOSS]
        X[x] = warmest + (X[x] - warmest) * math.exp(-sig[DT] / P[e + 2])
    sig[TEMP] = P[e] + X[x]
    return 0.0


@compiled
def warmer(reference: float, sig: Vector, X: Vector, x: int) -> float:
    """T - T0, K; X[x] if there is no thermometer, so that a simulation can set it."""
    return X[x] if math.isnan(sig[TEMP]) else sig[TEMP] - reference


def usual(signals: Array) -> float:
    """Mean temperature of logs, deg C: what is fitted without an effect of it applies there."""
    return float(np.nanmean(signals[:, TEMP]))


EFFECT = Effect(
    name="heating",
    title="heating by friction",
    effect_id=28,
    kernel=torque,
    cause="friction's loss warms the joint, which loses heat to its surroundings",
    form="tau dT/dt = ambient + R loss - T, loss = friction torque times velocity",
    source="thermal model of first order, Bittencourt and Gunnarsson (2012)",
    signature="none in the torque itself",
    separating_motion="measure the temperature",
    entry="scales the friction level",
    shape=("ambient", "resistance", "time_constant"),
    shape_units=("deg C", "K/W", "s"),
    shape_bounds=((-100.0, 300.0), (0.0, math.inf), (0.0, math.inf)),
)
