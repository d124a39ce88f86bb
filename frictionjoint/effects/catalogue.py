"""All effects the tracing knows, in the order in which ties between equals are broken.

`SIMULATED` are those that a model can carry: one more, which only a simulation has.
"""

from frictionjoint.effects import (
    back_emf,
    backlash,
    direction_asymmetry,
    dwell_time,
    end_stop,
    frictional_lag,
    gravity_error,
    heating,
    inertia_error,
    joint_elasticity,
    load_dependent,
    measurement_delay,
    motor_saturation,
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
    *load_dependent.FORMS,
    position_periodic.EFFECT,
    position_periodic.PERIODIC_LEVEL,
    nonlinear_viscous.EFFECT,
    direction_asymmetry.EFFECT,
    direction_asymmetry.BY_MOTION,
    temperature_dependent.EFFECT,
    warm_up_drift.EFFECT,
    warm_up_drift.BY_LOSS,
    measurement_delay.EFFECT,
    joint_elasticity.EFFECT,
    backlash.EFFECT,
    frictional_lag.EFFECT,
    dwell_time.EFFECT,
    end_stop.UPPER,
    end_stop.LOWER,
    back_emf.EFFECT,
    motor_saturation.EFFECT,
)

SIMULATED: tuple[Effect, ...] = (*CATALOGUE, heating.EFFECT)
