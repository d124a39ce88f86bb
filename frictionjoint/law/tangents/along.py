"""A law evaluated along a motion, with exact derivatives with respect to its parameters."""

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.law.kernel import row_size
from frictionjoint.law.tangents import kernels
from frictionjoint.law.tangents.direction import DIRECTIONS


def driven_with_tangents(
    law: str, P: Array, P_t: Array, time: Array, position: Array, edges: Index
) -> tuple[Array, Array, Array, Array]:
    """Hysteresis torque and dz/dq along a motion, and their derivatives by the law's parameters.

    At a sample where the law has a corner (an event falls on the sample) the derivatives are
    one-sided. A jump of the torque between samples does not appear in the derivatives.

    Args:
        law: its name. P: its parameter block, shape (m,).
        P_t: derivative of the block in each direction, shape (k, m).
        time, position: shape (n,), s and rad, as for `motion.drive_motions`.
        edges: of the separate motions, see `motion.drive_motions`.
    Returns:
        H, rate, each of shape (n,), and their derivatives in every direction, of shape (k, n).
    """
    drive = getattr(kernels, f"drive_{law}")
    H, rate = np.empty_like(position), np.empty_like(position)
    H_t, rate_t = np.empty((2, len(P_t), len(position)))
    X = np.empty(row_size(P, 0))
    X_t = np.empty((len(X), DIRECTIONS))
    for first in range(0, len(P_t), DIRECTIONS):
        some = slice(first, first + DIRECTIONS)
        block_t = np.zeros((len(P), DIRECTIONS))
        block_t[:, : len(P_t[some])] = P_t[some].T
        drive(P, block_t, time, position, edges, H, H_t[some], rate, rate_t[some], X, X_t)
    return H, rate, H_t, rate_t
