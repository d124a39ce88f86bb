"""The inertia that the signals of a log imply."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import GX, GY, A


def inertia_of(signals: Array, torque: int) -> float:
    """Inertia, kg m^2: rigid-body torque per acceleration; gravity is a function of position.

    Args:
        signals: of a log, shape (n, N_SIGNALS). torque: column, the whole load or the torque that
            the gear transmits.
    """
    columns = np.column_stack([signals[:, [A, GX, GY]], np.ones(len(signals))])
    return abs(float(np.linalg.lstsq(columns, signals[:, torque], rcond=None)[0][0]))
