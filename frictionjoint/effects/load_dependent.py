"""load-dependent: the friction level grows with the transmitted torque."""

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import LOAD, H


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| Fh/Fc."""
    return P[e] * abs(sig[LOAD]) * sig[H]


EFFECT = Effect(
    name="load-dependent",
    effect_id=7,
    coefficients=("c",),
    units=("1",),
    cause="tooth and bearing friction proportional to the normal force of the transmitted torque",
    form="c |tau_load| Fh/Fc",
    source="Bittencourt and Gunnarsson (2012); Duclusaud et al. (2024)",
    signature="odd in velocity, even in load",
    separating_motion="the same motion at two loads, or at two poses of different gravity torque",
    entry="scales the friction level",
    needs=(LOAD,),
    bounds=((0.0, 2.0),),
)
