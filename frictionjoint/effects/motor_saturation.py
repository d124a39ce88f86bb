"""motor-saturation: torque per ampere falls as the torque grows.

The iron of a motor saturates, its magnets weaken and its supply sags: all even in the current, so
what has to be asked for a torque T is T + s T^3 to first order. That inverts for every demand, and
has no limit that a fit could set below what the motor was seen to give.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import ASKED, MOTOR

# fraction of a torque that a double does not resolve
_NOTHING = 1e-17


@compiled
def given(asked: float, s: float) -> float:
    """The one T with T + s T^3 = asked, s >= 0 (Cardano, in its hyperbolic form)."""
    if s * asked * asked < _NOTHING:
        return asked
    scale = 2.0 / math.sqrt(3.0 * s)
    a = 3.0 * abs(asked) / scale
    # sinh(asinh(a)/3), without loss where a is small
    grown = math.expm1(math.log1p(a + a * a / (1.0 + math.sqrt(a * a + 1.0))) / 3.0)
    size = 0.5 * scale * (grown + grown / (1.0 + grown))
    return size if asked >= 0.0 else -size


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """s T^3, what is asked for and not given; a simulation knows what is asked for, a log T."""
    T = sig[MOTOR]
    return P[e] * T * T * T + sig[ASKED] - given(sig[ASKED], P[e])


EFFECT = Effect(
    name="motor-saturation",
    title="saturating motor",
    effect_id=26,
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
