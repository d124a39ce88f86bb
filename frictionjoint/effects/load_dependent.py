"""load-dependent: the friction level grows with the transmitted torque.

Two forms: all of the level grows, its fall with speed too, or the Coulomb part alone.
"""

from dataclasses import replace

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.level import reached, reaches
from frictionjoint.effects.signals import LOAD, H


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H, reached over `reach` of motion."""
    return P[e + 1] * reached(abs(sig[LOAD]) * sig[H], P[e], sig, X, x)


@njit(cache=True)
def coulomb_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H1, reached over `reach` of motion; H1 = H within +-1."""
    target = abs(sig[LOAD]) * min(1.0, max(-1.0, sig[H]))
    return P[e + 1] * reached(target, P[e], sig, X, x)


EFFECT = Effect(
    name="load-dependent",
    effect_id=7,
    coefficients=("c",),
    units=("1",),
    cause="tooth and bearing friction proportional to the normal force of the transmitted torque",
    form="c |tau_load| Fh/Fc, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); Duclusaud et al. (2024)",
    signature="odd in velocity, even in load",
    separating_motion="the same motion at two loads, or at two poses of different gravity torque",
    entry="scales the friction level",
    shape=("reach",),
    shape_units=("x",),
    shapes=reaches,
    needs=(LOAD,),
    bounds=((0.0, 2.0),),
    shape_bounds=((0.0, float("inf")),),
    memory=2,
)

COULOMB = replace(
    EFFECT, effect_id=22, form="c |tau_load| Fh/Fc within +-1, reached over `reach` of motion"
)
FORMS = (EFFECT, COULOMB)
