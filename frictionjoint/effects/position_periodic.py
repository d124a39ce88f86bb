"""position-periodic: cogging, torque ripple, eccentric gears; one harmonic per effect."""

import math
from dataclasses import replace

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.friction_level import reached
from frictionjoint.effects.signals import H, Q


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a sin(N q) + b cos(N q)."""
    angle = P[e] * sig[Q]
    return P[e + 1] * math.sin(angle) + P[e + 2] * math.cos(angle)


@compiled
def level_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(a sin(N q) + b cos(N q)) H, reached over `reach` of motion."""
    angle = P[e] * sig[Q]
    wave = P[e + 2] * math.sin(angle) + P[e + 3] * math.cos(angle)
    return reached(wave, wave, sig[H], P[e + 1], sig, X, x)


EFFECT = Effect(
    name="position-periodic",
    title="cogging",
    effect_id=11,
    kernel=torque,
    coefficients=("sin", "cos"),
    units=("T", "T"),
    cause="cogging, current ripple, eccentric gears: fixed in angle",
    form="a sin(N q) + b cos(N q)",
    source="Jahns and Soong (1996) on cogging and ripple",
    signature="fixed in position, same sign in both directions",
    separating_motion="slow motion over several periods, both directions",
    shape=("N",),
    shape_units=("1/x",),
    proposed_by="spectrum",
)

PERIODIC_LEVEL = replace(
    EFFECT,
    title="friction that varies with position",
    effect_id=12,
    kernel=level_torque,
    cause="a friction level that varies along the teeth",
    form="(a sin(N q) + b cos(N q)) Fh/Fc, reached over `reach` of motion",
    source="Armstrong-Helouvry (1991), position-dependent friction",
    signature="fixed in position, sign changes with the velocity",
    entry="scales the friction level",
    shape=("N", "reach"),
    shape_units=("1/x", "x"),
    shape_bounds=((0.0, math.inf), (0.0, math.inf)),
)
