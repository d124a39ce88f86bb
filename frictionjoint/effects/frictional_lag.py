"""frictional-lag: friction that follows a change of speed late."""

import math

from numba import njit

from frictionjoint.effects.effect import Array, Effect, Shape
from frictionjoint.effects.signals import DT, H


@njit(cache=True)
def torque(P, e, sig, X, x):
    """-c (H - H filtered with the time constant tau): the part of the dry torque not yet there."""
    h = sig[H]
    if sig[DT] <= 0.0:
        X[x] = h
    else:
        X[x] += (h - X[x]) * -math.expm1(-sig[DT] / P[e])
    return -P[e + 1] * (h - X[x])


def _time_constants(signals: Array) -> list[Shape]:
    return [(tau,) for tau in (0.005, 0.015, 0.05)]


EFFECT = Effect(
    name="frictional-lag",
    effect_id=17,
    coefficients=("level",),
    units=("T",),
    cause="the lubricant film takes time to build up or collapse",
    form="first order with time constant tau on the dry friction",
    source="Hess and Soom (1990)",
    signature="a loop in the torque-velocity plane at low speed that widens with frequency",
    separating_motion="unidirectional oscillating velocity near Vs at three frequencies",
    entry="scales the friction level",
    shape=("tau",),
    shape_units=("s",),
    shapes=_time_constants,
    memory=1,
)
