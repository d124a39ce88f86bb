"""Parts of a log in which another drive turns the joint while the joint's own drive is off.

A joint that coasts loses energy to its friction, about as much over a distance as when it is
driven. If another motor turns the joint, that motor supplies this energy. Then the balance of the
joint's own drive and the rigid body shows almost no friction.
"""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.repairs import silent_runs


def turned_by_another(
    log: JointLog, values: Array, grid: Array, lost: Array, velocity: Array
) -> tuple[tuple[float, float], ...]:
    """Start and end of each part in which another drive turns the joint, s in the log's time.

    Args:
        values: of the log's drive, at its samples. grid: times of the balance, s, shape (n,), of
            `lost`, drive minus rigid-body torque in units of the drive, and of the velocity.
    """
    silent = [
        (float(log.time[a]), float(log.time[b - 1]))
        for a, b in silent_runs(log.time, log.position, values)
    ]
    inside = [(grid >= a) & (grid <= b) for a, b in silent]
    driven = ~np.any([np.zeros(len(grid), dtype=bool), *inside], axis=0)
    usual = _friction(lost[driven], velocity[driven])
    # a coasting joint has about all of its usual friction
    return tuple(
        span
        for span, there in zip(silent, inside, strict=True)
        if _friction(lost[there], velocity[there]) < usual / 3.0
    )


def _friction(lost: Array, velocity: Array) -> float:
    """Friction as work over distance; 0 if nothing moves."""
    distance = float(np.sum(np.abs(velocity)))
    return float(np.sum(lost * velocity)) / distance if distance else 0.0
