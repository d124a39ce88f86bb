"""temperature-dependent: level and viscosity that fall with the temperature.

Two forms: both fall at the same rate, or each at its own rate. A small change of temperature cannot
distinguish them.

A log measures the temperature. In a simulation it is the state of `heating`, or it stays where it
was set.
"""

import math
from dataclasses import replace

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.heating import usual, warmer
from frictionjoint.effects.signals import TEMP, H, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(exp(-(T - T0)/s) - 1) (a Fh/Fc + b v); X[x] is T - T0, K, if T is not a signal."""
    change = math.expm1(-warmer(P[e], sig, X, x) / P[e + 1])
    return change * (P[e + 2] * sig[H] + P[e + 3] * sig[V])


@compiled
def apart_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a (exp(-(T - T0)/s) - 1) Fh/Fc + b (exp(-(T - T0)/sv) - 1) v; X[x] as in `torque`."""
    rise = warmer(P[e], sig, X, x)
    level = P[e + 3] * math.expm1(-rise / P[e + 1]) * sig[H]
    return level + P[e + 4] * math.expm1(-rise / P[e + 2]) * sig[V]


def _references(signals: Array) -> list[Shape]:
    # the last scale is almost linear
    return [(usual(signals), scale) for scale in (8.0, 20.0, 60.0, 300.0)]


EFFECT = Effect(
    name="temperature-dependent",
    title="friction that falls with temperature",
    effect_id=27,
    kernel=torque,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="lubricant viscosity and seal friction falling with temperature",
    form="(exp(-(T - T0)/s) - 1) (a Fh/Fc + b v)",
    source="Bittencourt and Gunnarsson (2012), Fv0 + FvT exp(-T/T0)",
    signature="same motion, friction that follows the measured temperature",
    separating_motion="the same motion cold and warm, and warm after a pause",
    entry="scales the friction level",
    slow=True,
    decays_over="scale",
    shape=("T0", "scale"),
    shape_units=("deg C", "K"),
    shape_fixed=1,
    shape_bounds=((-100.0, 300.0), (2.0, 1000.0)),
    shapes=_references,
    needs=(TEMP,),
)

APART = replace(
    EFFECT,
    effect_id=29,
    kernel=apart_torque,
    form="a (exp(-(T - T0)/s) - 1) Fh/Fc + b (exp(-(T - T0)/sv) - 1) v",
    source="Bittencourt and Gunnarsson (2012), levels and viscosity of their own rates",
    shape=("T0", "scale", "viscous_scale"),
    shape_units=("deg C", "K", "K"),
    shapes=lambda signals: [(T0, s, s) for T0, s in _references(signals)],
    shape_bounds=((-100.0, 300.0), (2.0, 1000.0), (2.0, 1000.0)),
)
FORMS = (EFFECT, APART)
