"""direction-asymmetry: friction levels that differ between the two directions.

Two forms, equal in sliding. After a reversal the difference either follows the hysteresis torque
through zero, or it stays until the joint has moved to the level of the other direction.
"""

from dataclasses import replace

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.friction_level import reached, reaches
from frictionjoint.effects.signals import H, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(dF |H| + dsigma2 |v|): half the difference between the directions."""
    return P[e] * abs(sig[H]) + P[e + 1] * abs(sig[V])


@compiled
def reached_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """dF sgn(v) H, reached over `reach` of motion, + dsigma2 |v|."""
    way = 1.0 if sig[V] >= 0.0 else -1.0
    return P[e + 1] * reached(way, way, sig[H], P[e], sig, X, x) + P[e + 2] * abs(sig[V])


EFFECT = Effect(
    name="direction-asymmetry",
    title="friction that differs with direction",
    effect_id=5,
    kernel=torque,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="gear tooth flanks, seals and preload that act differently in the two directions",
    form="dF |Fh/Fc| + dsigma2 |v|, half the difference between the directions",
    source="Ganseman et al. (1997), own parameters for each direction",
    signature="even in velocity, zero at rest before breakaway, grows with speed",
    separating_motion="both directions at two speeds, with stops in between",
    entry="scales the friction level",
)

BY_MOTION = replace(
    EFFECT,
    effect_id=23,
    kernel=reached_torque,
    form="dF sgn(v) Fh/Fc, reached over `reach` of motion, + dsigma2 |v|",
    shape=("reach",),
    shape_units=("x",),
    shapes=reaches,
    shape_bounds=((0.0, float("inf")),),
)
