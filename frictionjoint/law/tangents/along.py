"""A law driven along a motion, with its exact derivatives in any directions."""

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.law.kernel import row_size
from frictionjoint.law.motion import edges_of
from frictionjoint.law.tangents import kernels
from frictionjoint.law.tangents.direction import DIRECTIONS


def driven_with_tangents(
    law: str,
    P: Array,
    P_t: Array,
    time: Array,
    position: Array,
    position_t: Array | None = None,
    edges: Index | None = None,
) -> tuple[Array, Array, Array, Array]:
    """Hysteresis torque and dz/dq along a motion, and how they change with law and motion.

    At a sample where the law has a corner (an event falls on it, or the motion stands still while
    it is changed) the derivatives are one-sided; that a torque jumps elsewhere does not show.

    Args:
        law: its name. P: its block, shape (m,).
        P_t: how the block changes in each direction, shape (k, m).
        time, position: shape (n,), s and rad, as for `motion.drive_integrated`.
        position_t: how the motion changes in each direction, rad, shape (d, n) with d >= k: rows
            after the first k change the motion alone. None where the motion is given.
        edges: of the motions, see `motion.drive_integrated`; None: it is one.
    Returns:
        H, rate, each of shape (n,), and their derivatives in every direction, of shape (d, n).
    """
    if position_t is not None:
        P_t = np.pad(P_t, ((0, len(position_t) - len(P_t)), (0, 0)))
    edges = edges_of(position, edges)
    drive = getattr(kernels, f"drive_{law}")
    H, rate = np.empty_like(position), np.empty_like(position)
    H_t, rate_t = np.empty((2, len(P_t), len(position)))
    X = np.empty(row_size(P, 0))
    X_t = np.empty((len(X), DIRECTIONS))
    for first in range(0, len(P_t), DIRECTIONS):
        some = slice(first, first + DIRECTIONS)
        block_t = _padded(P_t[some])
        motion_t = np.empty((0, DIRECTIONS)) if position_t is None else _padded(position_t[some])
        drive(P, block_t, time, position, motion_t, edges, H, H_t[some], rate, rate_t[some], X, X_t)
    return H, rate, H_t, rate_t


def _padded(rows: Array) -> Array:
    """Columns of as many directions as a kernel takes, shape (m, DIRECTIONS)."""
    columns = np.zeros((rows.shape[1], DIRECTIONS))
    columns[:, : len(rows)] = rows.T
    return columns
