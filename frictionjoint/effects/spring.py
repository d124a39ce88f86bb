"""spring: a cable, a hose or a balancer pulling towards a rest position."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import Q


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k q + c, with the rest position q0 = -c / k."""
    return P[e] * sig[Q] + P[e + 1]


EFFECT = Effect(
    name="spring",
    title="spring or cable",
    effect_id=4,
    kernel=torque,
    coefficients=("stiffness", "preload"),
    plain=("stiffness", "preload"),
    units=("T/x", "T"),
    cause="cable, hose, balancing spring",
    form="k (q - q0), stored as k q + c",
    source="linear elasticity",
    signature="same sign in both directions, linear in position over the whole range",
    separating_motion="slow motion over more than half a turn, both directions",
    bounds=((0.0, float("inf")), (-float("inf"), float("inf"))),
)
