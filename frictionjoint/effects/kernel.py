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


@compiled
def effect_torque(effect_id: int, P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Torque of one effect, selected by its id.

    A kernel cannot use a table of functions, so a chain of conditions selects the effect. Ids 8 and
    15 belonged to effects that no longer exist.
    """
    if effect_id == 1:
        return torque_bias.torque(P, e, sig, X, x)
    if effect_id == 2:
        return gravity_error.torque(P, e, sig, X, x)
    if effect_id == 3:
        return inertia_error.torque(P, e, sig, X, x)
    if effect_id == 4:
        return spring.torque(P, e, sig, X, x)
    if effect_id == 5:
        return direction_asymmetry.torque(P, e, sig, X, x)
    if effect_id == 6:
        return nonlinear_viscous.torque(P, e, sig, X, x)
    if effect_id == 7:
        return load_dependent.torque(P, e, sig, X, x)
    if effect_id == 9:
        return warm_up_drift.torque(P, e, sig, X, x)
    if effect_id == 10:
        return back_emf.torque(P, e, sig, X, x)
    if effect_id == 11:
        return position_periodic.torque(P, e, sig, X, x)
    if effect_id == 12:
        return position_periodic.level_torque(P, e, sig, X, x)
    if effect_id == 13:
        return torque_gain.torque(P, e, sig, X, x)
    if effect_id == 14:
        return measurement_delay.torque(P, e, sig, X, x)
    if effect_id == 16:
        return end_stop.upper_torque(P, e, sig, X, x)
    if effect_id == 17:
        return frictional_lag.torque(P, e, sig, X, x)
    if effect_id == 18:
        return dwell_time.torque(P, e, sig, X, x)
    if effect_id == 19:
        return backlash.torque(P, e, sig, X, x)
    if effect_id == 20:
        return joint_elasticity.torque(P, e, sig, X, x)
    if effect_id == 21:
        return warm_up_drift.warmed_torque(P, e, sig, X, x)
    if effect_id == 22:
        return load_dependent.coulomb_torque(P, e, sig, X, x)
    if effect_id == 23:
        return direction_asymmetry.reached_torque(P, e, sig, X, x)
    if effect_id == 24:
        return end_stop.lower_torque(P, e, sig, X, x)
    if effect_id == 25:
        return load_dependent.stribeck_torque(P, e, sig, X, x)
    if effect_id == 26:
        return motor_saturation.torque(P, e, sig, X, x)
    if effect_id == 27:
        return temperature_dependent.torque(P, e, sig, X, x)
    if effect_id == 28:
        return heating.torque(P, e, sig, X, x)
    if effect_id == 29:
        return temperature_dependent.apart_torque(P, e, sig, X, x)
    if effect_id == 30:
        return motor_temperature.torque(P, e, sig, X, x)
    if effect_id == 31:
        return gravity_error.centred_torque(P, e, sig, X, x)
    if effect_id == 32:
        return end_stop.both_torque(P, e, sig, X, x)
    if effect_id == 33:
        return warm_up_drift.heated_torque(P, e, sig, X, x)
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
    numbers = np.empty((len(coefficients), len(shape) + coefficients.shape[1]))
    numbers[:, : len(shape)], numbers[:, len(shape) :] = shape, coefficients
    out = np.empty((len(signals), len(coefficients)))
    _fill(effect_id, numbers, np.ascontiguousarray(signals), out)
    return out


def columns(effect_id: int, shape: tuple[float, ...], n_coefficients: int, signals: Array) -> Array:
    """Torque per unit of each coefficient along a log, shape (n, n_coefficients)."""
    return torques(effect_id, shape, np.eye(n_coefficients), signals)
