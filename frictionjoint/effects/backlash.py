"""backlash: the link is driven through a gap, encoder on the motor."""

import math

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, GEAR, TIME, A

# longest substep, over the period of the flanks' resonance divided by 2 pi
_FINE = 0.25
# where a search starts: s to cross the gap, Hz, 1
_CROSSINGS, _FLANKS, _ZETA = tuple(0.01 * 1.3**k for k in range(10)), (8.0, 16.0), 0.45


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """What the flanks transmit, less what a rigid gear would.

    With p = J (q_link - q_motor): p'' = T - T_rigid, and T = -w^2 (p beyond the gap) - 2 zeta w p'
    while the flanks touch. Gap and p are scaled by the link's inertia J, which so need not be
    known. X[x] p, X[x+1] p', X[x+2] last T_rigid.
    """
    half, w, zeta = 0.5 * P[e], 2.0 * math.pi * P[e + 1], P[e + 2]
    rigid = sig[GEAR]
    h = sig[DT]
    if h <= 0.0:
        X[x] = (-half if rigid >= 0.0 else half) - rigid / (w * w)
        X[x + 1] = 0.0
        X[x + 2] = rigid
        return 0.0
    p, rate, last = X[x], X[x + 1], X[x + 2]
    pieces = 1 + int(h * w / _FINE)
    dt = h / float(pieces)
    impulse = 0.0
    for i in range(pieces):
        T = 0.0
        if abs(p) > half:
            flank = half if p > 0.0 else -half
            T = -w * w * (p - flank) - 2.0 * zeta * w * rate
            if T * p > 0.0:  # flanks push, they do not hold
                T = 0.0
        asked = last + (rigid - last) * (float(i) + 0.5) / float(pieces)
        rate += dt * (T - asked)
        p += dt * rate
        impulse += dt * T
    X[x] = p
    X[x + 1] = rate
    X[x + 2] = rigid
    return P[e + 3] * (impulse / h - 0.5 * (last + rigid))


def _gaps(signals: Array) -> list[Shape]:
    """Gaps that take ten to a hundred milliseconds to cross under the usual torque.

    The flanks start soft and well damped: the link is followed from the motor's motion alone, and
    a hard flank throws it back and forth after the least error in the moment of an impact.
    """
    usual = float(np.sqrt(np.mean(signals[:, GEAR] ** 2)))
    nyquist = 0.5 / float(np.median(np.diff(signals[:, TIME])))
    flanks = [f for f in _FLANKS if f < 0.5 * nyquist]
    return [(0.5 * usual * t * t, f, _ZETA) for t in _CROSSINGS for f in flanks]


EFFECT = Effect(
    name="backlash",
    title="play between gear teeth",
    effect_id=19,
    coefficients=("share",),
    units=("1",),
    cause="play between gear teeth",
    form="torque of a link driven through a gap with springy flanks, less that of a rigid gear",
    source="Nordin and Gutman (2002), dead-zone model",
    signature="no torque for some milliseconds after the transmitted torque changes sign, then "
    "an impact",
    separating_motion="slow motion in both directions through positions where gravity changes sign",
    shape=("gap_times_inertia", "flank_resonance", "damping_ratio"),
    shape_units=("T s^2", "Hz", "1"),
    shapes=_gaps,
    needs=(GEAR, A),
    bounds=((0.0, 1.5),),
    shape_bounds=((0.0, float("inf")), (0.5, float("inf")), (0.02, 1.0)),
    memory=3,
    acts="mechanism",
)
