"""Compare a velocity column with the derivative of the position."""

import numpy as np
from scipy.integrate import cumulative_trapezoid

from frictionjoint.measured.log import JointLog

# s over which displacements are compared: encoder counts average out
_WINDOW = 0.1
# ratio's distance from 1 that is said, and the squared correlation it takes to be sure
_APART, _SURE = 0.05, 0.9


def speed_note(log: JointLog) -> tuple[str, ...]:
    """A note if the velocity is not the derivative of the position; empty if it is."""
    if log.velocity is None:
        return ()
    integral = cumulative_trapezoid(log.velocity, log.time, initial=0.0)
    width = max(1, round(_WINDOW * (len(log.time) - 1) / log.duration))
    said, moved = (np.diff(x[::width]) for x in (integral, log.position))
    power, common, slopes = float(said @ said), float(said @ moved), float(moved @ moved)
    if common**2 <= _SURE * power * slopes or abs(common / power - 1.0) <= _APART:
        return ()
    return (
        f"{log.name}: the measured velocity is {power / common:.3g} times the slope of the "
        "position; the slope is used.",
    )
