"""end-stop: a spring that acts beyond a position; one form per end and one for both ends."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import Q


@compiled
def upper_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k (q - qmax)+."""
    return P[e + 1] * max(0.0, sig[Q] - P[e])


@compiled
def lower_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """-k (qmin - q)+."""
    return -P[e + 1] * max(0.0, P[e] - sig[Q])


@compiled
def both_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k ((q - qmax)+ - (qmin - q)+)."""
    return P[e + 2] * (max(0.0, sig[Q] - P[e]) - max(0.0, P[e + 1] - sig[Q]))


def _positions(end: Callable[[Array], float], signals: Array) -> list[Shape]:
    q = signals[:, Q]
    inward = 0.5 * float(q.min() + q.max()) - end(q)
    # fractions of the range; a hard stop yields very little
    depths = (0.005, 0.02, 0.05, 0.1, 0.15, 0.2)
    return [(float(end(q) + 2.0 * depth * inward),) for depth in depths]


def _pairs(signals: Array) -> list[Shape]:
    upper, lower = (_positions(end, signals) for end in (np.max, np.min))
    return [(*u, *w) for u, w in zip(upper, lower, strict=True)]


UPPER = Effect(
    name="end-stop",
    title="end stop",
    effect_id=16,
    kernel=upper_torque,
    coefficients=("stiffness",),
    units=("T/x",),
    cause="bumper, cable at its end, hard stop",
    form="k (q - qmax)+",
    source="unilateral linear spring",
    signature="acts near one end of the range only",
    separating_motion="approach the end slowly and dwell before it",
    shape=("upper",),
    shape_units=("x",),
    shapes=partial(_positions, np.max),
    bounds=((0.0, float("inf")),),
)

LOWER = replace(
    UPPER,
    effect_id=24,
    kernel=lower_torque,
    form="-k (qmin - q)+",
    shape=("lower",),
    shapes=partial(_positions, np.min),
)

BOTH = replace(
    UPPER,
    effect_id=32,
    kernel=both_torque,
    form="k ((q - qmax)+ - (qmin - q)+)",
    signature="acts near both ends of the range only",
    separating_motion="approach each end slowly and dwell before it",
    shape=("upper", "lower"),
    shape_units=("x", "x"),
    shapes=_pairs,
)
