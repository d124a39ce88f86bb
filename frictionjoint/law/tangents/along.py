"""A law driven along a given motion, with its exact derivatives in some directions of its block."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.law.tangents import kernels
from frictionjoint.law.tangents.direction import DIRECTIONS


def driven_with_tangents(
    law: str, P: Array, P_t: Array, time: Array, position: Array
) -> tuple[Array, Array, Array, Array]:
    """Hysteresis torque and dz/dq along a motion, and how they change with the law's numbers.

    At a sample where the law has a corner (an event falls on it) the derivatives are one-sided.

    Args:
        law: its name. P: its block, shape (m,).
        P_t: directions in which the block changes, shape (k, m).
        time, position: shape (n,), s and rad, as for `motion.drive_integrated`.
    Returns:
        H, rate, each of shape (n,), and their derivatives in every direction, of shape (k, n).
    """
    drive = getattr(kernels, f"drive_{law}")
    H, rate = np.empty_like(position), np.empty_like(position)
    H_t, rate_t = np.empty((2, len(P_t), len(position)))
    for first in range(0, len(P_t), DIRECTIONS):
        some = slice(first, first + DIRECTIONS)
        directions = np.zeros((len(P), DIRECTIONS))
        directions[:, : len(P_t[some])] = P_t[some].T
        drive(P, directions, time, position, H, H_t[some], rate, rate_t[some])
    return H, rate, H_t, rate_t
