"""nonlinear-viscous: viscous friction that is not proportional to speed."""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import HALT, V


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c sgn(v) |v|**p.

    In a simulation, at most what halves the speed within a step: with p < 1 the slope at rest is
    infinite, and a joint would vibrate and creep.
    """
    v = sig[V]
    if v == 0.0:
        return 0.0
    magnitude = P[e + 1] * float(abs(v) ** P[e])
    most = 0.5 * sig[HALT] * abs(v)
    if most > 0.0:
        magnitude = min(magnitude, most)
    return magnitude if v > 0.0 else -magnitude


EFFECT = Effect(
    name="nonlinear-viscous",
    title="curved viscous friction",
    effect_id=6,
    kernel=torque,
    coefficients=("c",),
    of_speed=True,
    units=("T (s/x)^p",),
    cause="grease and hydrodynamic lubrication; churning losses",
    form="c sgn(v) |v|**p; concave (p < 1) in geared joints, quadratic in churning",
    source="Waiboer, Aarts and Jonker (2005) for the concave form",
    signature="odd in velocity; curvature beyond the Stribeck and linear viscous terms",
    separating_motion="constant velocities over the whole speed range, both directions",
    shape=("p",),
    shape_units=("1",),
    shapes=lambda signals: [(p,) for p in (0.3, 0.5, 0.7, 1.5, 2.0, 3.0)],
    bounds=((0.0, float("inf")),),
    shape_bounds=((0.1, 4.0),),
)
