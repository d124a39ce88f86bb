"""Effects fixed in position: waves along it, one harmonic per effect; springs at its ends."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.friction_level import reached
from frictionjoint.effects.signals import H, Q


@compiled
def wave_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a sin(N q) + b cos(N q)."""
    angle = P[e] * sig[Q]
    return P[e + 1] * math.sin(angle) + P[e + 2] * math.cos(angle)


@compiled
def level_wave_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(a sin(N q) + b cos(N q)) H, reached over `reach` of motion."""
    angle = P[e] * sig[Q]
    wave = P[e + 2] * math.sin(angle) + P[e + 3] * math.cos(angle)
    return reached(wave, wave, sig[H], P[e + 1], sig, X, x)


POSITION_PERIODIC = Effect(
    name="position-periodic",
    title="cogging",
    effect_id=11,
    kernel=wave_torque,
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
    POSITION_PERIODIC,
    title="friction that varies with position",
    effect_id=12,
    kernel=level_wave_torque,
    cause="a friction level that varies along the teeth",
    form="(a sin(N q) + b cos(N q)) Fh/Fc, reached over `reach` of motion",
    source="Armstrong-Helouvry (1991), position-dependent friction",
    signature="fixed in position, sign changes with the velocity",
    entry="scales the friction level",
    shape=("N", "reach"),
    shape_units=("1/x", "x"),
    shape_bounds=((0.0, math.inf), (0.0, math.inf)),
)


@compiled
def upper_stop_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k (q - qmax)+."""
    return P[e + 1] * max(0.0, sig[Q] - P[e])


@compiled
def lower_stop_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """-k (qmin - q)+."""
    return -P[e + 1] * max(0.0, P[e] - sig[Q])


@compiled
def both_stops_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k ((q - qmax)+ - (qmin - q)+)."""
    return P[e + 2] * (max(0.0, sig[Q] - P[e]) - max(0.0, P[e + 1] - sig[Q]))


def _positions(end: Callable[[Array], float], signals: Array) -> list[Shape]:
    q = signals[:, Q]
    inward = 0.5 * float(q.min() + q.max()) - end(q)
    # fractions of the range; a hard stop yields very little
    depths = (0.005, 0.02, 0.05, 0.1, 0.15, 0.2)
    return [(float(end(q) + 2.0 * depth * inward),) for depth in depths]


def _both_positions(signals: Array) -> list[Shape]:
    upper, lower = (_positions(end, signals) for end in (np.max, np.min))
    return [(*u, *w) for u, w in zip(upper, lower, strict=True)]


UPPER_STOP = Effect(
    name="end-stop",
    title="end stop",
    effect_id=16,
    kernel=upper_stop_torque,
    coefficients=("stiffness",),
    units=("T/x",),
    cause="bumper, cable at its end, hard stop",
    form="k (q - qmax)+",
    source="unilateral linear spring",
    signature="acts near one end of the range only",
    separating_motion="approach the end slowly and dwell before it",
    shape=("upper",),
    shape_units=("x",),
    shapes=partial(_positions, np.max),
    bounds=((0.0, float("inf")),),
)

LOWER_STOP = replace(
    UPPER_STOP,
    effect_id=24,
    kernel=lower_stop_torque,
    form="-k (qmin - q)+",
    shape=("lower",),
    shapes=partial(_positions, np.min),
)

BOTH_STOPS = replace(
    UPPER_STOP,
    effect_id=32,
    kernel=both_stops_torque,
    form="k ((q - qmax)+ - (qmin - q)+)",
    signature="acts near both ends of the range only",
    separating_motion="approach each end slowly and dwell before it",
    shape=("upper", "lower"),
    shape_units=("x", "x"),
    shapes=_both_positions,
)
