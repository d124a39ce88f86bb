"""Corners of the filters of a balance, and the samples that they do not spoil."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d


@dataclass(frozen=True)
class Band:
    """Corners of the filters of the torque balance and of the motion, Hz; whether a measured drive
    is constant from one sample to the next, and whether samples at the end of its range are
    unused."""

    balance: float
    motion: float
    zero_order_hold: bool = False
    sensor_saturates: bool = False


def clear_of(unknown: NDArray[np.bool_], bandwidth_hz: float, dt: float) -> NDArray[np.bool_]:
    """Samples at least one period of the filter's corner away from unknown torque, which the filter
    spreads over that time, shape (n,)."""
    reach = max(1, int(1.0 / (bandwidth_hz * dt)))
    return np.asarray(~maximum_filter1d(unknown, 2 * reach + 1, mode="constant", cval=False))
