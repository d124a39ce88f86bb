"""gravity-error: a payload or an offset mass that the MJCF lacks."""

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import GX, GY


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """mx Gx + my Gy, first moments of mass about the joint times unit gravity torques."""
    return P[e] * sig[GX] + P[e + 1] * sig[GY]


EFFECT = Effect(
    name="gravity-error",
    title="payload or wrong mass",
    effect_id=2,
    coefficients=("moment_x", "moment_y"),
    units=("kg m", "kg m"),
    cause="payload, wrong mass or wrong centre of mass of everything beyond the joint",
    form="mx Gx(q) + my Gy(q); for a lone horizontal hinge a cos q + b sin q",
    source="first moments of the inverse dynamics, Atkeson, An and Hollerbach (1986)",
    signature="same sign in both directions, smooth in position with the period of one turn",
    separating_motion="slow motion over at least half a turn, both directions",
    needs=(GX, GY),
)
