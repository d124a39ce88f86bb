"""Stiff joints of one mechanism hold their loads together.

`law.ahead` solves one joint's own implicit step. In an arm the step of each moves the others: with
W the inverse of the mass matrix between the stiff joints, v- and F- of the last step,

    v+ = v + h (v - v-)/dt - h W (F(q + h v+, v+) - F-)

where all other torque is as it was over the last step. Solved joint after joint (Gauss-Seidel; W is
symmetric and positive, torque rises with displacement), starting from F-, which is the answer
where a load is held.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
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


@in_line
def is_stiff(P: Vector, p: int, X: Vector, x: int, h: float, weight: float) -> bool:
    """Whether the explicit torque of an evaluated row would not do; weight: inverse inertia."""
    if h == 0.0 or X[x + T_EVALUATED] == X[x + T_COMMITTED]:
        return False
    K, damping = presliding(P, p)
    return bool(h * (h * K + damping) * weight > STIFF)


@compiled
def settle(P: Vector, blocks: Vector, k: int, X: Vector, h: float, W: Vector, Y: Vector) -> None:
    """Torques of stiff joints at the end of a step, N m; the rows' TORQUE is overwritten.

    Args:
        blocks: addresses of the k joints' blocks in P, shape (k,). W: kg^-1 m^-2, shape (k k,).
        Y: room for 3 k numbers and a law's row. The first k become that by which the torques
        differ from the explicit ones, N m.
    """
    F, ahead, trial = k, 2 * k, 3 * k
    for i in range(k):
        if not W[i * k + i] > 0.0:
            for j in range(k):
                Y[j] = 0.0
            return  # called before the mass matrix was made
    for i in range(k):
        x = int(P[int(blocks[i]) + ROW])
        Y[i] = X[x + TORQUE_COMMITTED]
        Y[F + i] = Y[i]
        v, dt = X[x + V_EVALUATED], X[x + T_EVALUATED] - X[x + T_COMMITTED]
        Y[ahead + i] = v + h * (v - X[x + V_COMMITTED]) / dt
    for _ in range(_SWEEPS):
        moved = 0.0
        for i in range(k):
            block = int(blocks[i])
            x = int(P[block + ROW])
            v, J = X[x + V_EVALUATED], 1.0 / W[i * k + i]
            end = Y[ahead + i]
            for j in range(k):
                if j != i:
                    end -= h * W[i * k + j] * (Y[F + j] - Y[j])
            f = J * (end - v) / h + Y[i]
            new = torque_ahead(P, block + HEAD, X, x + FRONT, Y, trial, h, f, J, v)
            moved = max(moved, abs(new - Y[F + i]) / (abs(new) + abs(Y[F + i]) + 1e-300))
            Y[F + i] = new
        if moved <= _SETTLED or k == 1:
            break
    for i in range(k):
        x = int(P[int(blocks[i]) + ROW])
        Y[i] = Y[F + i] - X[x + TORQUE]
        X[x + TORQUE] = Y[F + i]


@compiled
def between(P: Vector, blocks: Vector, k: int, columns: Vector, nv: int, W: Vector) -> None:
    """Fill W, shape (k k,), from columns of the inverse of M, that of the i-th joint at nv i."""
    for i in range(k):
        for j in range(k):
            W[j * k + i] = columns[nv * i + int(P[int(blocks[j]) + DOF])]
