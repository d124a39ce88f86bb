"""torque-gain: a wrong motor constant, as a fraction of the known load."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import LOAD


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """e tau_load."""
    return P[e] * sig[LOAD]


EFFECT = Effect(
    name="torque-gain",
    title="wrong motor constant",
    effect_id=13,
    kernel=torque,
    coefficients=("gain",),
    units=("1",),
    cause="motor constant, gear efficiency or current scale that differs from the assumed one",
    form="(1 + e) tau, relative to the rigid-body torque; friction scales too",
    source="Gautier and Briot (2014), on drive gains",
    signature="scales inertia and gravity torque alike",
    separating_motion="a known extra load, and motion both fast and slow",
    entry="acts on the measurement",
    drives=("torque",),
    needs=(LOAD,),
    # below -1 the sign of the log would be wrong
    bounds=((-1.0, float("inf")),),
)
