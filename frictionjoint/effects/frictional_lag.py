"""frictional-lag: friction that follows a change of speed late."""

import math

from numba import njit

from frictionjoint.effects.effect import Array, Effect, Shape
from frictionjoint.effects.signals import DT, H


@njit(cache=True)
def torque(P, e, sig, X, x):
    """c sgn(H) (L filtered with the time constant tau - L), L = max(|Fh/Fc|, 1) the sliding level.

    The level is late, the direction is not: a reversal turns friction round at once.
    """
    h = sig[H]
    level = max(abs(h), 1.0)
    if sig[DT] <= 0.0:
        X[x] = level
    else:
        X[x] += (level - X[x]) * -math.expm1(-sig[DT] / P[e])
    return math.copysign(P[e + 1] * (X[x] - level), h)


def _time_constants(signals: Array) -> list[Shape]:
    return [(tau,) for tau in (0.005, 0.01, 0.02, 0.04, 0.08)]


EFFECT = Effect(
    name="frictional-lag",
    effect_id=17,
    coefficients=("level",),
    units=("T",),
    cause="the lubricant film takes time to build up or collapse",
    form="c sgn(v) (S late by a first order with time constant tau - S)",
    source="Hess and Soom (1990)",
    signature="a loop in the torque-velocity plane at low speed that widens with frequency",
    separating_motion="unidirectional oscillating velocity near Vs at three frequencies",
    bounds=((0.0, float("inf")),),
    entry="scales the friction level",
    shape=("tau",),
    shape_units=("s",),
    shapes=_time_constants,
    memory=1,
)
