"""All effects the tracing knows, in the order in which ties between equals are broken."""

from frictionjoint.effects import (
    back_emf,
    backlash,
    direction_asymmetry,
    dwell_time,
    end_stop,
    frictional_lag,
    gravity_error,
    inertia_error,
    joint_elasticity,
    load_dependent,
    measurement_delay,
    nonlinear_viscous,
    position_periodic,
    spring,
    temperature_dependent,
    torque_bias,
    torque_gain,
    warm_up_drift,
)
from frictionjoint.effects.effect import Effect

CATALOGUE: tuple[Effect, ...] = (
    torque_bias.EFFECT,
    inertia_error.EFFECT,
    gravity_error.EFFECT,
    torque_gain.EFFECT,
    spring.EFFECT,
    load_dependent.EFFECT,
    position_periodic.EFFECT,
    position_periodic.PERIODIC_LEVEL,
    nonlinear_viscous.EFFECT,
    direction_asymmetry.EFFECT,
    temperature_dependent.EFFECT,
    warm_up_drift.EFFECT,
    measurement_delay.EFFECT,
    joint_elasticity.EFFECT,
    backlash.EFFECT,
    frictional_lag.EFFECT,
    dwell_time.EFFECT,
    end_stop.EFFECT,
    back_emf.EFFECT,
)


def by_id(effect_id: int) -> Effect:
    """The effect with this kernel number."""
    return next(effect for effect in CATALOGUE if effect.effect_id == effect_id)
