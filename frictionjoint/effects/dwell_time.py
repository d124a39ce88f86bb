"""dwell-time: stiction that grows while the joint rests."""

import math

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, H, Q, V


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c ln(1 + t_rest/tau) Fh/Fc exp(-travel/length) after a rest below the speed v0.

    X[x] time at rest that counts, X[x+1] position where it rested, X[x+2] 1 while at rest.
    """
    if sig[DT] <= 0.0:
        X[x] = 0.0
        X[x + 1] = sig[Q]
        X[x + 2] = 0.0
    if abs(sig[V]) < P[e + 2] and abs(sig[Q] - X[x + 1]) < P[e + 1]:
        if X[x + 2] == 0.0:
            X[x] = 0.0
            X[x + 2] = 1.0
        X[x] += sig[DT]
    elif abs(sig[V]) >= P[e + 2]:
        X[x + 2] = 0.0
    else:
        X[x + 1] = sig[Q]
    travel = abs(sig[Q] - X[x + 1])
    if travel > 20.0 * P[e + 1] and X[x + 2] == 0.0:
        X[x + 1] = sig[Q]
        X[x] = 0.0
        return 0.0
    return P[e + 3] * math.log1p(X[x] / P[e]) * sig[H] * math.exp(-travel / P[e + 1])


def _shapes(signals: Array) -> list[Shape]:
    span = float(np.ptp(signals[:, Q]))
    slow = 0.02 * float(np.abs(signals[:, V]).max())
    return [(tau, part * span, slow) for tau in (0.1, 1.0) for part in (1e-3, 1e-2)]


EFFECT = Effect(
    name="dwell-time",
    effect_id=18,
    coefficients=("level",),
    units=("T",),
    cause="contact creep and lubricant squeezed out at rest",
    form="c ln(1 + t_rest/tau) Fh/Fc exp(-travel/length)",
    source="Rabinowicz (1958); Gonthier et al. (2004)",
    signature="only the first breakaway after a rest, larger after longer rests",
    separating_motion="the same start after rests of 1, 10 and 100 s",
    entry="scales the friction level",
    shape=("tau", "length", "v_rest"),
    shape_units=("s", "x", "x/s"),
    shapes=_shapes,
    bounds=((0.0, float("inf")),),
    memory=3,
)
