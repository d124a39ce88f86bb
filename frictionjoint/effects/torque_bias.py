"""torque-bias: a constant torque."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c."""
    return P[e]


EFFECT = Effect(
    name="torque-bias",
    title="constant torque offset",
    effect_id=1,
    kernel=torque,
    coefficients=("bias",),
    plain=("preload",),
    units=("T",),
    cause="current sensor offset, preload of a seal or a balancer",
    form="c",
    source="Gautier (1997), offset term of the identification model",
    signature="constant, with the same sign in both directions",
    separating_motion="move through the same range in both directions and stop in between",
)
