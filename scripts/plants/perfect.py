"""What the plant's own friction law leaves when it is driven by the logged motion.

A log tells a motion by samples of an encoder. Between them, and below a count, nobody knows how the
joint moved, and presliding turns that into torque: this much a model that is true leaves too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from . import loop
from .parts import JOINT
from .plant import Trial, assemble, constants


def law_error(trial: Trial, number: int, time: NDArray, acceleration: NDArray) -> NDArray:
    """Error of the true law along the logged positions of one log, N m, at `time`.

    Args:
        number: of the log. time: s on the clock of the log. acceleration: of the logged motion
            there, rad/s^2, from which the load of the gear follows.
    """
    parts, log = assemble(trial.spec), trial.logs[number]
    position = log.get("position_rad", log.get(f"{JOINT}.position_rad"))
    late = log["time_s"] - parts.delay
    fine = np.arange(late[0], late[-1], trial.spec.step)
    torque = np.zeros(fine.size)
    k, alpha = parts.elements()
    loop.replay(
        constants(parts, number), k, alpha, CubicSpline(late, position)(fine),
        np.interp(fine, time, acceleration), torque,
    )  # fmt: skip
    there = np.interp(log["time_s"], fine, torque)
    return np.asarray(np.interp(time, log["time_s"], there - trial.friction[number]))
