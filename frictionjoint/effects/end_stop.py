"""end-stop: a spring that acts only beyond a position."""

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import Q


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k (q - qmax)+ for side +1, k (qmin - q)+ for side -1, pushing back."""
    depth = P[e + 1] * (sig[Q] - P[e])
    return P[e + 1] * P[e + 2] * depth if depth > 0.0 else 0.0


def _positions(signals: Array) -> list[Shape]:
    q = signals[:, Q]
    low, high = float(q.min()), float(q.max())
    parts = np.array([0.02, 0.05, 0.1, 0.15, 0.2])
    top = [(high - part * (high - low), 1.0) for part in parts]
    return top + [(low + part * (high - low), -1.0) for part in parts]


EFFECT = Effect(
    name="end-stop",
    effect_id=16,
    coefficients=("stiffness",),
    units=("T/x",),
    cause="bumper, cable at its end, hard stop",
    form="k (q - qmax)+",
    source="unilateral linear spring",
    signature="nothing but near one end of the range",
    separating_motion="approach the end slowly and dwell before it",
    shape=("position", "side"),
    shape_units=("x", "1"),
    shapes=_positions,
    bounds=((0.0, float("inf")),),
)
