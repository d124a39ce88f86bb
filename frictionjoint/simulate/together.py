"""Stiff joints of one mechanism hold their loads together.

`law.ahead` solves one joint's own implicit step. In an arm the step of each moves the others: with
W the inverse of the mass matrix between the stiff joints, v- and F- of the last step,

    v+ = v + h (v - v-)/dt - h W (F(q + h v+, v+) - F-)

where all other torque is as it was over the last step. Solved joint after joint (Gauss-Seidel; W is
symmetric and positive, the torque rises with the way gone), starting from F-, which is the answer
already where a load is held.
"""

import numpy as np
from numba import njit

from frictionjoint.arrays import Array, Vector
from frictionjoint.law.ahead import STIFF, torque_ahead
from frictionjoint.law.kernel import presliding
from frictionjoint.simulate.carrier import DOF, HEAD, ROW
from frictionjoint.simulate.row import (
    FRONT,
    T_COMMITTED,
    T_EVALUATED,
    TORQUE,
    TORQUE_COMMITTED,
    V_COMMITTED,
    V_EVALUATED,
)

_SWEEPS = 50
_SETTLED = 1e-12


@njit(cache=True)
def is_stiff(P: Vector, p: int, X: Vector, x: int, h: float, weight: float) -> bool:
    """Whether the explicit torque of an evaluated row would not do; weight: inverse inertia."""
    if h == 0.0 or X[x + T_EVALUATED] == X[x + T_COMMITTED]:
        return False
    K, damping = presliding(P, p)
    return bool(h * (h * K + damping) * weight > STIFF)


@njit(cache=True)
def settle(P: Vector, blocks: Vector, X: Vector, h: float, W: Array) -> Array:
    """Torques of stiff joints at the end of a step, N m; the rows' TORQUE is overwritten.

    Args:
        blocks: addresses of the joints' blocks in P, shape (k,). W: kg^-1 m^-2, shape (k, k).
    Returns:
        by how much the torques differ from the explicit ones, shape (k,).
    """
    k = len(blocks)
    for i in range(k):
        if not W[i, i] > 0.0:
            return np.zeros(k)  # called before the mass matrix was made
    F, before, ahead = np.empty(k), np.empty(k), np.empty(k)
    for i in range(k):
        x = int(P[int(blocks[i]) + ROW])
        before[i] = X[x + TORQUE_COMMITTED]
        F[i] = before[i]
        v, dt = X[x + V_EVALUATED], X[x + T_EVALUATED] - X[x + T_COMMITTED]
        ahead[i] = v + h * (v - X[x + V_COMMITTED]) / dt
    for _ in range(_SWEEPS):
        moved = 0.0
        for i in range(k):
            block = int(blocks[i])
            x = int(P[block + ROW])
            v, J = X[x + V_EVALUATED], 1.0 / W[i, i]
            end = ahead[i]
            for j in range(k):
                if j != i:
                    end -= h * W[i, j] * (F[j] - before[j])
            f = J * (end - v) / h + before[i]
            new = torque_ahead(P, block + HEAD, X, x + FRONT, h, f, J, v)
            moved = max(moved, abs(new - F[i]) / (abs(new) + abs(F[i]) + 1e-300))
            F[i] = new
        if moved <= _SETTLED or k == 1:
            break
    for i in range(k):
        x = int(P[int(blocks[i]) + ROW])
        before[i] = F[i] - X[x + TORQUE]
        X[x + TORQUE] = F[i]
    return before


@njit(cache=True)
def between(P: Vector, blocks: Vector, columns: Array) -> Array:
    """W from columns of the inverse of M, columns[i] that of the i-th joint's dof, shape (k, k)."""
    k = len(blocks)
    W = np.empty((k, k))
    for i in range(k):
        for j in range(k):
            W[j, i] = columns[i, int(P[int(blocks[j]) + DOF])]
    return W
