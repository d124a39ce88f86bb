"""motor-temperature: torque per volt or ampere that changes as the motor warms.

Copper resists by 0.39% a kelvin more, magnets give 0.1 to 0.2% a kelvin less. What a servo measures
is its housing or its board, of which the winding is several times as far above the surroundings as
the reading says: a change per kelvin of the reading may well be several times those.

To first order, what has to be asked for a torque M is M (1 + a (T - T0)). A log measures T. In a
simulation it rests where it was set, as that of `temperature-dependent`.
"""

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import ASKED, MOTOR, TEMP
from frictionjoint.effects.thermometer import warmer

# least and largest of what is asked for over what is given: beyond, the first order means nothing
_LEAST, _MOST = 0.2, 5.0


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """a (T - T0) M, asked for and not given; a simulation knows what is asked for, a log M.

    X[x] is T - T0, K, where T is not a signal.
    """
    change = P[e + 1] * warmer(P[e], sig, X, x)
    asked_over_given = min(_MOST, max(_LEAST, 1.0 + change))
    return change * sig[MOTOR] + sig[ASKED] - sig[ASKED] / asked_over_given


def _references(signals: Array) -> list[Shape]:
    # the gain of the drive holds at the mean temperature of its logs
    return [(float(np.nanmean(signals[:, TEMP])),)]


EFFECT = Effect(
    name="motor-temperature",
    title="motor that weakens as it warms",
    effect_id=30,
    coefficients=("a",),
    units=("1/K",),
    cause="a winding that resists more and magnets that give less as they warm",
    form="M (1 + a (T - T0)) commanded, M delivered",
    source="temperature coefficients of copper and of magnets, to first order",
    signature="same motion, a drive per torque that follows the measured temperature",
    separating_motion="the same motion cold and warm, and warm after a pause",
    entry="acts on the motor",
    drives=("voltage", "current"),
    on_motor=True,
    slow=True,
    shape=("T0",),
    shape_units=("deg C",),
    shape_fixed=1,
    shape_bounds=((-100.0, 300.0),),
    shapes=_references,
    needs=(TEMP, MOTOR),
    memory=1,
)
