"""dwell-time: stiction that grows while the joint rests."""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.friction_level import reached
from frictionjoint.effects.signals import DT, H, Q, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c times the fraction r of the contact that has aged, reached over `reach` of motion.

    dr/dt = (1 - r)/tau - |v| r/slip: rest ages the contact, sliding renews it.
    X[x] r, X[x+1] torque per unit of c, X[x+2] last position.
    """
    h = sig[DT]
    if h <= 0.0:
        X[x] = 1.0  # the joint has been at rest for long before the log
    else:
        rate = 1.0 / P[e] + abs(sig[V]) / P[e + 1]
        steady = 1.0 / (P[e] * rate)
        X[x] = steady + (X[x] - steady) * math.exp(-rate * h)
    return P[e + 3] * reached(0.0, X[x], sig[H], P[e + 2], sig, X, x + 1)


def _shapes(signals: Array) -> list[Shape]:
    span = float(np.ptp(signals[:, Q]))
    slips = (1e-4, 5e-4, 2e-3, 8e-3)  # over the travel
    return [(tau, x * span, 0.1 * x * span) for tau in (0.2, 1.0) for x in slips]


EFFECT = Effect(
    name="dwell-time",
    title="stiction that grows at rest",
    effect_id=18,
    kernel=torque,
    coefficients=("level",),
    units=("T",),
    cause="contact creep and lubricant squeezed out at rest",
    form="c r Fh/Fc, reached over `reach` of motion; dr/dt = (1 - r)/tau - |v| r/slip",
    source="Rabinowicz (1958); Dieterich (1979), ageing that saturates",
    signature="only the first breakaway after a rest, larger after longer rests",
    separating_motion="the same start after rests of 1, 10 and 100 s",
    entry="scales the friction level",
    shape=("tau", "slip", "reach"),
    shape_units=("s", "x", "x"),
    shapes=_shapes,
    bounds=((0.0, float("inf")),),
    shape_bounds=((0.1, float("inf")), (0.0, float("inf")), (0.0, float("inf"))),
)
