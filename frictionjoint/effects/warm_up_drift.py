"""warm-up-drift: level and viscosity relaxing in time, the temperature unmeasured."""

import math

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import TIME, H, V


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-t/tau) (a Fh/Fc + b v)."""
    return math.exp(-sig[TIME] / P[e]) * (P[e + 1] * sig[H] + P[e + 2] * sig[V])


def _time_constants(signals: Array) -> list[Shape]:
    duration = float(np.ptp(signals[:, TIME]))
    return [(duration * part,) for part in (0.1, 0.3, 1.0, 3.0)]


EFFECT = Effect(
    name="warm-up-drift",
    effect_id=9,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="losses warm the lubricant while the joint works",
    form="exp(-t/tau) (a Fh/Fc + b v), t from the start of the log",
    source="Bittencourt and Gunnarsson (2012), thermal model of first order",
    signature="same motion, friction that changes slowly with time",
    separating_motion="the same motion repeated for several time constants, with a long pause",
    entry="scales the friction level",
    slow=True,
    shape=("tau",),
    shape_units=("s",),
    shapes=_time_constants,
)
