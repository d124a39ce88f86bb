"""inertia-error: inertia that the MJCF lacks."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import A


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """dJ a."""
    return P[e] * sig[A]


EFFECT = Effect(
    name="inertia-error",
    title="wrong inertia",
    effect_id=3,
    kernel=torque,
    coefficients=("inertia",),
    plain=("armature",),
    units=("T s^2/x",),
    cause="rotor inertia through the gear, payload, wrong link inertia",
    form="dJ a",
    source="Armstrong, Khatib and Burdick (1986)",
    signature="proportional to acceleration at every frequency",
    separating_motion="fast motion at two frequencies at least a factor of two apart",
    needs=(A,),
    is_inertia=True,
)
