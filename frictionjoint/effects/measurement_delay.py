"""measurement-delay: torque and position sampled at different times."""

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import DTAU


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """T d(tau)/dt: the first order of tau(t + T)."""
    return P[e] * sig[DTAU]


EFFECT = Effect(
    name="measurement-delay",
    effect_id=14,
    coefficients=("delay",),
    units=("s",),
    cause="filters and buses that delay one channel against the other",
    form="T d(tau)/dt",
    source="first-order expansion of the delayed torque",
    signature="proportional to the rate of the whole torque; one T explains all speeds",
    separating_motion="two motions of the same shape at different speeds",
    entry="acts on the measurement",
    needs=(DTAU,),
)
