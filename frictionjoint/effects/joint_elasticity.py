"""joint-elasticity: motor and link joined by a spring."""

from numba import njit

from frictionjoint.arrays import Vector
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import JERK, SNAP


@njit(cache=True)
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a snap + b jerk: below the resonance the link lags its motor in these derivatives."""
    return P[e] * sig[SNAP] + P[e + 1] * sig[JERK]


EFFECT = Effect(
    name="joint-elasticity",
    effect_id=15,
    coefficients=("snap", "jerk"),
    units=("T s^4/x", "T s^3/x"),
    cause="compliant gear or shaft between motor and link",
    form="a d4q/dt4 + b d3q/dt3, valid below the resonance",
    source="Spong (1987), elastic-joint model expanded below resonance",
    signature="follows the fourth derivative; grows with frequency to the fourth",
    separating_motion="fast motion with frequencies up to a third of the resonance",
    needs=(SNAP, JERK),
)
