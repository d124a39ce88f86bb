"""Signals that effects may use: one row per sample, equal in logs and simulations.

TIME   s since the start of the log or simulation
Q V A  position, velocity, acceleration (rad or m)
SAG    gravity torque of the link behind the gear over its inertia, rad/s^2
SWAY   derivative of SAG by the position, 1/s^2; both zero in simulation
LOAD   rigid-body torque of the MJCF at this joint, N m
GEAR   LOAD without the armature: torque that the gear transmits
GX GY  gravity torque of 1 kg at 1 m along the child body's two axes across the joint, N m/kg/m
TEMP   temperature, deg C; not a number in a simulation that has no `heating`
H      Fh / Fc, the hysteresis torque in units of the Coulomb level: +-1 in sliding
DTAU   time derivative of the predicted torque, N m/s; zero in simulation
DT     s since the previous sample
RATE   dz/dq of the bristle, 1 at a reversal and 0 in sliding; zero in simulation
MOTOR  motor torque, N m, for models fitted to voltages or currents; zero in simulation
ASKED  commanded motor torque, N m; zero in a log
LOSS   friction power, W, for `heating`; zero in a log
HALT   damping that stops the joint within one time step, N m s/rad; zero in a log: no step
ONSET  presliding displacement Fc/K, rad; zero in a log
SHARE  stiffness of an effect that scales the level, relative to that of the law; not in a log
RAISED torque of such effects times SHARE, N m; not in a log
"""

import numpy as np

from frictionjoint.arrays import Array

TIME, Q, V, A, SAG, SWAY, LOAD, GX, GY, TEMP, H, DTAU, DT, RATE = range(14)
GEAR, MOTOR, ASKED, LOSS, HALT, ONSET, SHARE, RAISED = range(RATE + 1, RATE + 9)
N_SIGNALS = RAISED + 1


def parts_of_load(signals: Array) -> Array:
    """Inertia, kg m^2, and first moments of mass, kg m, that LOAD contains; shape (3,).

    Args:
        signals: shape (n, N_SIGNALS).
    """
    return np.asarray(np.linalg.lstsq(signals[:, [A, GX, GY]], signals[:, LOAD], rcond=None)[0])


def inertia_of(signals: Array, torque: int) -> float:
    """Inertia, kg m^2: rigid-body torque per acceleration; gravity is a function of position.

    Args:
        signals: of a log, shape (n, N_SIGNALS). torque: column, the whole load or the torque that
            the gear transmits.
    """
    columns = np.column_stack([signals[:, [A, GX, GY]], np.ones(len(signals))])
    return abs(float(np.linalg.lstsq(columns, signals[:, torque], rcond=None)[0][0]))
