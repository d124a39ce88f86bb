"""back-emf: the voltage a turning motor induces, seen as a torque proportional to speed."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """kt**2/R v."""
    return P[e] * sig[V]


EFFECT = Effect(
    name="back-emf",
    title="back-EMF",
    effect_id=10,
    kernel=torque,
    coefficients=("kt2_over_R",),
    of_speed=True,
    units=("T s/x",),
    cause="motor driven by voltage: current falls with speed",
    form="kt^2/R v",
    source="equation of the DC motor",
    signature="voltage-driven joint; linear in velocity, larger than viscous friction",
    separating_motion="measure the current, or the winding resistance at standstill",
    bounds=((0.0, float("inf")),),
    # for other drives sigma2 already contains every term that is linear in velocity
    drives=("voltage",),
    first=True,
    opposes_voltage=True,
    on_motor=True,
)
