"""temperature-dependent: level and viscosity that change with the measured temperature."""

import math

from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import TEMP, H, V


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(T - T0) (a Fh/Fc + b v); nothing where no temperature is known: the joint is at T0."""
    if math.isnan(sig[TEMP]):
        return 0.0
    return (sig[TEMP] - P[e]) * (P[e + 1] * sig[H] + P[e + 2] * sig[V])


def _reference(signals: Array) -> list[Shape]:
    # the base fit holds at the mean temperature of its logs: measure from there
    return [(float(signals[:, TEMP].mean()),)]


EFFECT = Effect(
    name="temperature-dependent",
    effect_id=8,
    coefficients=("level_per_K", "viscous_per_K"),
    units=("T/K", "T s/x/K"),
    cause="lubricant viscosity and seal friction falling with temperature",
    form="(T - T0) (a Fh/Fc + b v), the first order of Fv0 + FvT exp(-T/T0)",
    source="Bittencourt and Gunnarsson (2012)",
    signature="same motion, friction that follows the measured temperature",
    separating_motion="the same motion cold and warm, and warm after a pause",
    entry="scales the friction level",
    slow=True,
    shape=("T0",),
    shape_units=("deg C",),
    shape_fixed=True,
    shapes=_reference,
    needs=(TEMP,),
)
