"""The inertia that signals of a log show."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import GX, GY, A


def inertia_of(signals: Array, torque: int) -> float:
    """A torque of the rigid body over its acceleration, kg m^2; gravity goes with the position.

    Args:
        signals: of a log, shape (n, N_SIGNALS). torque: column of them, all of the load or what
            the gear transmits.
    """
    columns = np.column_stack([signals[:, [A, GX, GY]], np.ones(len(signals))])
    return abs(float(np.linalg.lstsq(columns, signals[:, torque], rcond=None)[0][0]))
