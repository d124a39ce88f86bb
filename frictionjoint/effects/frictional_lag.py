"""frictional-lag: friction that follows a change of speed with a delay."""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.friction_level import reached, within_one
from frictionjoint.effects.signals import DT, H, Q, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c H1 (E delayed with the time constant tau - E), E = exp(-(v/Vs)^2), H1 = H within +-1.

    Only the level is delayed. At a reversal friction changes direction without delay.
    X[x] delayed E, X[x+1] torque per unit of c, X[x+2] last position.
    """
    ratio = sig[V] / P[e + 1]
    level = math.exp(-ratio * ratio)
    if sig[DT] <= 0.0:
        X[x] = level
    else:
        X[x] += (level - X[x]) * -math.expm1(-sig[DT] / P[e])
    return P[e + 3] * reached(0.0, X[x] - level, within_one(sig[H]), P[e + 2], sig, X, x + 1)


def _lags(signals: Array) -> list[Shape]:
    top = float(np.quantile(np.abs(signals[:, V]), 0.99))
    reach = 5e-4 * float(np.ptp(signals[:, Q]))
    taus, speeds = (0.01, 0.03, 0.08), (0.03, 0.08, 0.2)
    return [(tau, share * top, reach) for tau in taus for share in speeds if top > 0.0]


EFFECT = Effect(
    name="frictional-lag",
    title="lag of the lubricant film",
    effect_id=17,
    kernel=torque,
    coefficients=("level",),
    units=("T",),
    cause="the lubricant film takes time to build up or collapse",
    form="c Fh/Fc (E late by a first order with time constant tau - E), E = exp(-(v/Vs)^2), "
    "reached over `reach` of motion",
    source="Hess and Soom (1990)",
    signature="a loop in the torque-velocity plane at low speed that widens with frequency",
    separating_motion="unidirectional oscillating velocity near Vs at three frequencies",
    bounds=((0.0, float("inf")),),
    entry="scales the friction level",
    shape=("tau", "Vs", "reach"),
    shape_units=("s", "x/s", "x"),
    shapes=_lags,
    shape_bounds=((0.005, 1.0), (0.0, float("inf")), (0.0, float("inf"))),
)
