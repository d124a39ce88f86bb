"""measurement-delay: torque and position sampled at different times.

A fit compares the drive at an earlier time with the logged motion, so the whole model is late by T,
including the steps of friction at reversals. The kernel is the first-order approximation.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import DTAU


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """T d(tau)/dt: the first order of tau(t + T)."""
    return P[e] * sig[DTAU]


EFFECT = Effect(
    name="measurement-delay",
    title="delay between torque and position",
    effect_id=14,
    kernel=torque,
    cause="filters and buses that delay one channel against the other",
    form="tau(t + T), T the time by which the position is logged late",
    source="pure delay between two channels",
    signature="proportional to the rate of the whole torque; one T explains all speeds",
    separating_motion="two motions of the same shape at different speeds",
    entry="acts on the measurement",
    delays=True,
    acts="sensors",
    shape=("delay",),
    shape_units=("s",),
    shapes=lambda signals: [(0.0,)],
    # a larger delay means that the channels do not belong together
    shape_bounds=((-0.1, 0.1),),
)
