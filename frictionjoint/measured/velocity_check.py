"""Compare a velocity column with the derivative of the position."""

import numpy as np
from scipy.integrate import cumulative_trapezoid

from frictionjoint.measured.log import JointLog


def speed_note(log: JointLog) -> tuple[str, ...]:
    """A note if the velocity is not the derivative of the position; empty if it is."""
    if log.velocity is None:
        return ()
    integral = cumulative_trapezoid(log.velocity, log.time, initial=0.0)
    # over 0.1 s encoder counts average out
    width = max(1, round(0.1 * (len(log.time) - 1) / log.duration))
    said, moved = (np.diff(x[::width]) for x in (integral, log.position))
    power, common, slopes = float(said @ said), float(said @ moved), float(moved @ moved)
    # only a correlation above 0.95 is sure, and only a ratio 5% off is stated
    if common**2 <= 0.9 * power * slopes or abs(common / power - 1.0) <= 0.05:
        return ()
    return (
        f"{log.name}: the measured velocity is {power / common:.3g} times the slope of the "
        "position; the slope is used.",
    )
