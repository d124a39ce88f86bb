"""gravity-error: a payload or an offset mass that the MJCF lacks."""

from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import GX, GY, LOAD, parts_of_load


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """mx Gx + my Gy, first moments of mass about the joint times unit gravity torques."""
    return P[e] * sig[GX] + P[e + 1] * sig[GY]


@compiled
def centred_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """m (cx Gx + cy Gy), in the direction (cx, cy) of the MJCF's own first moment."""
    return P[e + 2] * (P[e] * sig[GX] + P[e + 1] * sig[GY])


def _directions(signals: Array) -> list[Shape]:
    """Direction of the MJCF's first moment; none if gravity does not load the joint."""
    moment = parts_of_load(signals)[1:]
    torque = np.ptp(signals[:, [GX, GY]] @ moment)
    # a moment this small, relative to the largest, has no direction
    if torque <= 1e-6 * np.ptp(signals[:, LOAD]):
        return []
    # adding zero takes the sign off a zero
    # 12 decimals: less is rounding of the model's own numbers
    cx, cy = (np.round(moment / np.linalg.norm(moment), 12) + 0.0).tolist()
    return [(cx, cy)]


EFFECT = Effect(
    name="gravity-error",
    title="payload or wrong mass",
    effect_id=2,
    kernel=torque,
    coefficients=("moment_x", "moment_y"),
    units=("kg m", "kg m"),
    cause="payload, wrong mass or wrong centre of mass of everything beyond the joint",
    form="mx Gx(q) + my Gy(q); for a lone horizontal hinge a cos q + b sin q",
    source="first moments of the inverse dynamics, Atkeson, An and Hollerbach (1986)",
    signature="same sign in both directions, smooth in position with the period of one turn",
    separating_motion="slow motion over at least half a turn, both directions",
    needs=(GX, GY),
)

# a heavier link is one number, like a wrong motor constant
ALONG_CENTRE = replace(
    EFFECT,
    effect_id=31,
    kernel=centred_torque,
    coefficients=("moment",),
    units=("kg m",),
    form="m (cx Gx + cy Gy), towards the model's own centre of mass",
    shape=("cx", "cy"),
    shape_units=("1", "1"),
    shape_fixed=2,
    shapes=_directions,
    needs=(GX, GY, LOAD),
)
