"""One entry point for all effects, for logs and simulations.

A block ``P[e:]`` contains the number of effects, then per effect its id, the count of its numbers
and the numbers (shape first, then coefficients). Memory ``X[x:]`` has `MEMORY` numbers per effect.
"""

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, pointer, room
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
    motor_temperature,
    nonlinear_viscous,
    position_periodic,
    spring,
    temperature_dependent,
    torque_bias,
    torque_gain,
    warm_up_drift,
)

MEMORY = 3

_bias = torque_bias.torque
_gravity = gravity_error.torque
_gravity_along = gravity_error.centred_torque
_inertia = inertia_error.torque
_spring = spring.torque
_asymmetry = direction_asymmetry.torque
_asymmetry_reached = direction_asymmetry.reached_torque
_viscous = nonlinear_viscous.torque
_load = load_dependent.torque
_load_coulomb = load_dependent.coulomb_torque
_load_stribeck = load_dependent.stribeck_torque
_temperature = temperature_dependent.torque
_temperature_apart = temperature_dependent.apart_torque
_warm_up = warm_up_drift.torque
_warmed = warm_up_drift.warmed_torque
_emf = back_emf.torque
_periodic = position_periodic.torque
_periodic_level = position_periodic.level_torque
_gain = torque_gain.torque
_delay = measurement_delay.torque
_upper_stop = end_stop.upper_torque
_lower_stop = end_stop.lower_torque
_both_stops = end_stop.both_torque
_lag = frictional_lag.torque
_dwell = dwell_time.torque
_backlash = backlash.torque
_saturation = motor_saturation.torque
_motor_temperature = motor_temperature.torque
_motor_side = joint_elasticity.torque
_heating = heating.torque


@compiled
def effect_torque(effect_id: int, P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Torque of one effect, selected by its id.

    A kernel cannot use a table of functions, so a chain of conditions selects the effect. Ids 8 and
    15 belonged to effects that no longer exist.
    """
    if effect_id == 1:
        return _bias(P, e, sig, X, x)
    if effect_id == 2:
        return _gravity(P, e, sig, X, x)
    if effect_id == 3:
        return _inertia(P, e, sig, X, x)
    if effect_id == 4:
        return _spring(P, e, sig, X, x)
    if effect_id == 5:
        return _asymmetry(P, e, sig, X, x)
    if effect_id == 6:
        return _viscous(P, e, sig, X, x)
    if effect_id == 7:
        return _load(P, e, sig, X, x)
    if effect_id == 9:
        return _warm_up(P, e, sig, X, x)
    if effect_id == 10:
        return _emf(P, e, sig, X, x)
    if effect_id == 11:
        return _periodic(P, e, sig, X, x)
    if effect_id == 12:
        return _periodic_level(P, e, sig, X, x)
    if effect_id == 13:
        return _gain(P, e, sig, X, x)
    if effect_id == 14:
        return _delay(P, e, sig, X, x)
    if effect_id == 16:
        return _upper_stop(P, e, sig, X, x)
    if effect_id == 17:
        return _lag(P, e, sig, X, x)
    if effect_id == 18:
        return _dwell(P, e, sig, X, x)
    if effect_id == 19:
        return _backlash(P, e, sig, X, x)
    if effect_id == 20:
        return _motor_side(P, e, sig, X, x)
    if effect_id == 21:
        return _warmed(P, e, sig, X, x)
    if effect_id == 22:
        return _load_coulomb(P, e, sig, X, x)
    if effect_id == 23:
        return _asymmetry_reached(P, e, sig, X, x)
    if effect_id == 24:
        return _lower_stop(P, e, sig, X, x)
    if effect_id == 25:
        return _load_stribeck(P, e, sig, X, x)
    if effect_id == 26:
        return _saturation(P, e, sig, X, x)
    if effect_id == 27:
        return _temperature(P, e, sig, X, x)
    if effect_id == 28:
        return _heating(P, e, sig, X, x)
    if effect_id == 29:
        return _temperature_apart(P, e, sig, X, x)
    if effect_id == 30:
        return _motor_temperature(P, e, sig, X, x)
    if effect_id == 31:
        return _gravity_along(P, e, sig, X, x)
    if effect_id == 32:
        return _both_stops(P, e, sig, X, x)
    return np.nan


@compiled
def total_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int, each: int) -> float:
    """Sum over the block's effects in a simulation; X[each:] becomes the torque of each.

    Effects that act through the mechanism or the sensors add no torque.
    """
    total = 0.0
    at = e + 1
    for i in range(int(P[e])):
        effect_id = int(P[at])
        X[each + i] = 0.0
        if effect_id != 14 and effect_id != 19 and effect_id != 20:
            X[each + i] = effect_torque(effect_id, P, at + 2, sig, X, x + MEMORY * i)
        total += X[each + i]
        at += 2 + int(P[at + 1])
    return total


@compiled
def _centred(out: Array) -> None:
    """Means over the interval before each sample, converted to means around each sample."""
    for k in range(len(out) - 1):
        for c in range(out.shape[1]):
            out[k, c] = 0.5 * (out[k, c] + out[k + 1, c])


# releases the GIL: a search computes columns in parallel
@compiled
def _fill(effect_id: int, numbers: Array, signals: Array, out: Array) -> None:
    """Torque of one effect; column j of `out` uses row j of its numbers."""
    X, start = room(MEMORY), 0
    for c in range(len(numbers)):
        P = pointer(numbers, c * numbers.shape[1])
        for i in range(MEMORY):
            X[i] = 0.0
        for k in range(signals.shape[0]):
            sig = pointer(signals, k * signals.shape[1])
            out[k, c] = effect_torque(effect_id, P, start, sig, X, start)
    if effect_id == 19:
        _centred(out)


def torques(effect_id: int, shape: tuple[float, ...], coefficients: Array, signals: Array) -> Array:
    """Torque along a log, shape (n, m).

    Args:
        coefficients: linear ones, shape (m, k). signals: shape (n, N_SIGNALS).
    """
    numbers = np.column_stack([np.tile(np.array(shape), (len(coefficients), 1)), coefficients])
    out = np.empty((len(signals), len(coefficients)))
    _fill(effect_id, numbers, np.ascontiguousarray(signals), out)
    return out


def columns(effect_id: int, shape: tuple[float, ...], n_coefficients: int, signals: Array) -> Array:
    """Torque per unit of each coefficient along a log, shape (n, n_coefficients)."""
    return torques(effect_id, shape, np.eye(n_coefficients), signals)
