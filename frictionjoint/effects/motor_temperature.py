"""motor-temperature: torque per volt or ampere that changes as the motor warms.

The resistance of copper rises by 0.39% per kelvin, and magnets weaken by 0.1 to 0.2% per kelvin. A
servo measures its housing or its board; the winding is several times further above ambient, so the
change per kelvin of the reading may be several times larger.

To first order a torque M requires a commanded torque of M (1 + a (T - T0)). A log measures T. In a
simulation T stays where it was set, as for `temperature-dependent`.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.heating import usual, warmer
from frictionjoint.effects.signals import ASKED, MOTOR, TEMP


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a (T - T0) M, commanded but not delivered; a simulation knows the command, a log knows M.

    X[x] is T - T0, K, if T is not a signal.
    """
    change = P[e + 1] * warmer(P[e], sig, X, x)
    # range in which the first order is meaningful
    asked_over_given = min(5.0, max(0.2, 1.0 + change))
    return change * sig[MOTOR] + sig[ASKED] - sig[ASKED] / asked_over_given


EFFECT = Effect(
    name="motor-temperature",
    title="motor that weakens as it warms",
    effect_id=30,
    kernel=torque,
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
