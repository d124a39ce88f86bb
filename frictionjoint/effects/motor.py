"""Effects of the motor: a wrong motor constant, back-EMF, saturation, temperature.

Saturation: torque per ampere falls as the torque grows. Iron saturates, magnets weaken and the
supply voltage falls, all even in the current. So a torque T requires a commanded torque of
T + s T^3 to first order. This can be inverted for every command and has no limit that a fit could
set below an observed torque.

Temperature: the resistance of copper rises by 0.39% per kelvin, and magnets weaken by 0.1 to 0.2%
per kelvin. A servo measures its housing or its board; the winding is several times further above
ambient, so the change per kelvin of the reading may be several times larger. To first order a
torque M requires a commanded torque of M (1 + a (T - T0)). A log measures T. In a simulation T
stays where it was set, as for `temperature-dependent`.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.heating import usual, warmer
from frictionjoint.effects.signals import ASKED, LOAD, MOTOR, TEMP, V


@compiled
def gain_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """e tau_load."""
    return P[e] * sig[LOAD]


TORQUE_GAIN = Effect(
    name="torque-gain",
    title="wrong motor constant",
    effect_id=13,
    kernel=gain_torque,
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


@compiled
def emf_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """kt**2/R v."""
    return P[e] * sig[V]


BACK_EMF = Effect(
    name="back-emf",
    title="back-EMF",
    effect_id=10,
    kernel=emf_torque,
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
def saturation_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """s T^3, commanded but not delivered; a simulation knows the command, a log knows T."""
    T = sig[MOTOR]
    return P[e] * T * T * T + sig[ASKED] - given(sig[ASKED], P[e])


SATURATION = Effect(
    name="motor-saturation",
    title="saturating motor",
    effect_id=26,
    kernel=saturation_torque,
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


@compiled
def temperature_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a (T - T0) M, commanded but not delivered; a simulation knows the command, a log knows M.

    X[x] is T - T0, K, if T is not a signal.
    """
    change = P[e + 1] * warmer(P[e], sig, X, x)
    # range in which the first order is meaningful
    asked_over_given = min(5.0, max(0.2, 1.0 + change))
    return change * sig[MOTOR] + sig[ASKED] - sig[ASKED] / asked_over_given


TEMPERATURE = Effect(
    name="motor-temperature",
    title="motor that weakens as it warms",
    effect_id=30,
    kernel=temperature_torque,
    coefficients=("a",),
    units=("1/K",),
    cause="winding resistance that rises and magnets that weaken as the motor warms",
    form="M (1 + a (T - T0)) commanded, M delivered",
    source="temperature coefficients of copper and of magnets, to first order",
    signature="in the same motion, the drive per torque follows the measured temperature",
    separating_motion="the same motion cold and warm, and warm after a pause",
    entry="acts on the motor",
    drives=("voltage", "current"),
    on_motor=True,
    slow=True,
    shape=("T0",),
    shape_units=("deg C",),
    shape_fixed=1,
    shape_bounds=((-100.0, 300.0),),
    shapes=lambda signals: [(usual(signals),)],
    needs=(TEMP, MOTOR),
)
