"""A law evaluated along a motion, with exact derivatives with respect to its parameters."""

import numpy as np

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import PLAIN, compiled
from frictionjoint.law import bristle, memory
from frictionjoint.law import kernel as laws
from frictionjoint.law.memory import FH
from frictionjoint.law.tangents.direction import DIRECTIONS, ZERO, put

if PLAIN:
    from frictionjoint.law.tangents.generate import steps
else:
    steps = None  # the compiled library has them


@compiled
def _drive(
    P: Vector,
    P_t: Vector,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Vector,
) -> None:
    """`motion.drive_motions` with the tangents of H and of `rate`; X, X_t: room for the state."""
    slip = memory.RATE if P[0] == laws.INTEGRATED else bristle.RATE
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        if P[0] == laws.INTEGRATED:
            steps.integrated_start(P, P_t, 1, X, X_t, 0, memory.HEADER)
        else:
            laws.start_row(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[slip]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            if P[0] == laws.INTEGRATED:
                steps.integrated_step(P, P_t, 1, X, X_t, 0, 0, memory.HEADER, dq, dt, dq / dt)
                steps.memory_make_room(X, X_t, 0, memory.HEADER)
            else:
                steps.kernel_step_rival(P, P_t, 0, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[FH], X[slip]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[DIRECTIONS * FH + i], X_t[DIRECTIONS * slip + i]


def driven_with_tangents(
    P: Array, P_t: Array, time: Array, position: Array, edges: Index
) -> tuple[Array, Array, Array, Array]:
    """Hysteresis torque and dz/dq along a motion, and their derivatives by the law's parameters.

    At a sample where the law has a corner (an event falls on the sample) the derivatives are
    one-sided. A jump of the torque between samples does not appear in the derivatives.

    Args:
        P: parameter block of any law, shape (m,).
        P_t: derivative of the block in each direction, shape (k, m).
        time, position: shape (n,), s and rad, as for `motion.drive_motions`.
        edges: of the separate motions, see `motion.drive_motions`.
    Returns:
        H, rate, each of shape (n,), and their derivatives in every direction, of shape (k, n).
    """
    H, rate = np.empty_like(position), np.empty_like(position)
    H_t, rate_t = np.empty((2, len(P_t), len(position)))
    X = np.empty(laws.row_size(P, 0))
    X_t = np.empty(len(X) * DIRECTIONS)
    for first in range(0, len(P_t), DIRECTIONS):
        some = slice(first, first + DIRECTIONS)
        block_t = np.zeros((len(P), DIRECTIONS))
        block_t[:, : len(P_t[some])] = P_t[some].T
        _drive(P, block_t.ravel(), time, position, edges, H, H_t[some], rate, rate_t[some], X, X_t)
    return H, rate, H_t, rate_t
