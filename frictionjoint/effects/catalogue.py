"""All effects that the search knows; among equals the first one is preferred.

`SIMULATED` lists the effects that a model can contain, one more than `CATALOGUE`, and `EVERY` those
of the drive too, which are searched for when the drive is reconstructed from target and position.
"""

import copyreg
from typing import Any

from frictionjoint.effects import (
    friction_level,
    gear,
    heating,
    measurement_delay,
    motor,
    nonlinear_viscous,
    position,
    rigid_body,
    temperature_dependent,
    warm_up_drift,
)
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.effects.effect import Effect

CATALOGUE: tuple[Effect, ...] = (
    rigid_body.TORQUE_BIAS,
    rigid_body.INERTIA_ERROR,
    rigid_body.GRAVITY_ERROR,
    rigid_body.GRAVITY_ALONG_CENTRE,
    motor.TORQUE_GAIN,
    rigid_body.SPRING,
    *friction_level.LOAD_FORMS,
    position.POSITION_PERIODIC,
    position.PERIODIC_LEVEL,
    nonlinear_viscous.EFFECT,
    friction_level.DIRECTION_ASYMMETRY,
    friction_level.DIRECTION_BY_MOTION,
    *temperature_dependent.FORMS,
    *warm_up_drift.FORMS,
    measurement_delay.EFFECT,
    gear.JOINT_ELASTICITY,
    gear.BACKLASH,
    friction_level.FRICTIONAL_LAG,
    friction_level.DWELL_TIME,
    position.UPPER_STOP,
    position.LOWER_STOP,
    position.BOTH_STOPS,
    motor.BACK_EMF,
    motor.SATURATION,
    motor.TEMPERATURE,
)

SIMULATED: tuple[Effect, ...] = (*CATALOGUE, heating.EFFECT)

EVERY = (*SIMULATED, *DRIVE_EFFECTS)


def title(name: str, form: str | int = "") -> str:
    """Common name of an effect, from its canonical name; a location after " of " is kept.

    An effect without a title is called by its canonical name, with spaces instead of dashes.

    Args:
        form: cause or `effect_id` of the form that acts, where an effect has several.
    """
    own, of, place = name.partition(" of ")
    forms = [e for e in EVERY if e.name == own and e.title]
    acting = [e for e in forms if form in (e.cause, e.effect_id)] or forms
    return (acting[0].title if acting else own.replace("-", " ")) + of + place


def _numbered(number: int) -> Effect:
    return EVERY[number]


def _reduced(effect: Effect) -> Any:
    """Pickle an effect by its index in the catalogue; other processes then get the same object."""
    number = next((i for i, known in enumerate(EVERY) if known is effect), None)
    return object.__reduce_ex__(effect, 2) if number is None else (_numbered, (number,))


copyreg.pickle(Effect, _reduced)
