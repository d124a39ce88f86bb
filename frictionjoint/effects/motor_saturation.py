"""motor-saturation: torque per ampere falls as the torque grows.

Iron saturates, magnets weaken and the supply voltage falls, all even in the current. So a torque T
requires a commanded torque of T + s T^3 to first order. This can be inverted for every command and
has no limit that a fit could set below an observed torque.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import ASKED, MOTOR


@compiled
def given(asked: float, s: float) -> float:
    """Torque T that solves T + s T^3 = asked, s >= 0 (Cardano, hyperbolic form)."""
    # below the relative resolution of a double
    if s * asked * asked < 1e-17:
        return asked
    scale = 2.0 / math.sqrt(3.0 * s)
    a = 3.0 * abs(asked) / scale
    # sinh(asinh(a)/3), without loss where a is small
    grown = math.expm1(math.log1p(a + a * a / (1.0 + math.sqrt(a * a + 1.0))) / 3.0)
    size = 0.5 * scale * (grown + grown / (1.0 + grown))
    return size if asked >= 0.0 else -size


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """s T^3, commanded but not delivered; a simulation knows the command, a log knows T."""
    T = sig[MOTOR]
    return P[e] * T * T * T + sig[ASKED] - given(sig[ASKED], P[e])


EFFECT = Effect(
    name="motor-saturation",
    title="saturating motor",
    effect_id=26,
    kernel=torque,
    coefficients=("s",),
    units=("1/(T)^2",),
    cause="iron that saturates, magnets that weaken, a supply that sags with the current",
    form="T + s T^3 commanded, T delivered",
    source="first term of a saturation that is even in the current",
    signature="odd in the motor's torque, at every speed and position",
    separating_motion="the same motion with a known extra load",
    entry="acts on the motor",
    drives=("voltage", "current"),
    on_motor=True,
    needs=(MOTOR,),
    bounds=((0.0, float("inf")),),
)
