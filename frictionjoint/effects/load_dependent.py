"""load-dependent: the friction level grows with the transmitted torque.

Three forms: the whole level grows, including the Stribeck part; only the Coulomb part grows; or the
Coulomb part and a separate Stribeck part grow.
"""

import math
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.friction_level import reached, reaches, within_one
from frictionjoint.effects.signals import GEAR, H, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H, reached over `reach` of motion."""
    load = abs(sig[GEAR])
    return P[e + 1] * reached(load, load, sig[H], P[e], sig, X, x)


@compiled
def coulomb_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H1, reached over `reach` of motion; H1 = H within +-1."""
    load = abs(sig[GEAR])
    return P[e + 1] * reached(load, load, within_one(sig[H]), P[e], sig, X, x)


@compiled
def stribeck_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(c + cs exp(-|v|/vs)) |load| H1, reached over `reach` of motion; H1 = H within +-1."""
    level = abs(sig[GEAR]) * (P[e + 2] + P[e + 3] * math.exp(-abs(sig[V]) / P[e + 1]))
    return reached(level, level, within_one(sig[H]), P[e], sig, X, x)


def _reaches_and_falls(signals: Array) -> list[Shape]:
    fastest = float(np.quantile(np.abs(signals[:, V]), 0.99))
    lengths = reaches(signals) if fastest > 0.0 else []
    return [(length, part * fastest) for (length,) in lengths for part in (0.03, 0.15)]


EFFECT = Effect(
    name="load-dependent",
    title="friction that grows with load",
    effect_id=7,
    kernel=torque,
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
    needs=(GEAR,),
    of_size=True,
    bounds=((0.0, 2.0),),
    shape_bounds=((0.0, float("inf")),),
)

COULOMB = replace(
    EFFECT,
    effect_id=22,
    kernel=coulomb_torque,
    form="c |tau_load| Fh/Fc within +-1, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); with Dahl's law the loss in MuJoCo's issue 3528",
)
STRIBECK = replace(
    EFFECT,
    effect_id=25,
    kernel=stribeck_torque,
    coefficients=("c", "cs"),
    units=("1", "1"),
    form="(c + cs exp(-|v|/vs)) |tau_load| Fh/Fc within +-1, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); Duclusaud et al. (2024), model M4",
    shape=("reach", "vs"),
    shape_units=("x", "x/s"),
    shapes=_reaches_and_falls,
    bounds=((0.0, 2.0), (0.0, 4.0)),
    shape_bounds=((0.0, float("inf")), (0.0, float("inf"))),
)
FORMS = (EFFECT, COULOMB, STRIBECK)
