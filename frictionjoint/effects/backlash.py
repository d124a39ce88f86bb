"""backlash: lost motion whenever the transmitted torque changes sign."""

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, LOAD, Q


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """-c tau_load while the motor crosses the gap after the load has changed sign.

    X[x] sign of the load, X[x+1] position where it changed.
    """
    side = 1.0 if sig[LOAD] >= 0.0 else -1.0
    if sig[DT] <= 0.0:
        X[x] = side
        X[x + 1] = sig[Q] + 2.0 * P[e]
    elif side != X[x]:
        X[x] = side
        X[x + 1] = sig[Q]
    return -P[e + 1] * sig[LOAD] if abs(sig[Q] - X[x + 1]) < P[e] else 0.0


def _gaps(signals: Array) -> list[Shape]:
    span = float(np.ptp(signals[:, Q]))
    return [(part * span,) for part in (1e-3, 3e-3, 1e-2, 3e-2)]


EFFECT = Effect(
    name="backlash",
    effect_id=19,
    coefficients=("share",),
    units=("1",),
    cause="play between gear teeth",
    form="-c tau_load within a gap after each change of sign of the transmitted torque",
    source="Nordin and Gutman (2002)",
    signature="lost motion near zero transmitted torque, impact when the gap closes",
    separating_motion="slow motion through positions where gravity changes sign, both ways",
    shape=("gap",),
    shape_units=("x",),
    shapes=_gaps,
    needs=(LOAD,),
    bounds=((0.0, 1.5),),
    memory=2,
)
