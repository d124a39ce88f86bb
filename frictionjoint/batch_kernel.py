"""Kernels of `FrictionBatch`: torque, stiffness and damping of joints over a step."""

import math

from frictionjoint.arrays import Index, Vector
from frictionjoint.compiled import compiled, pointer
from frictionjoint.law.secant import secant
from frictionjoint.simulate import row

# a joint's state: time and position as counted here, position given last and the step taken then,
# the row of `simulate.row`
CLOCK, PLACE, SHOWN, STEP, ROW = range(5)


@compiled
def step_joint(
    P: Vector,
    p: int,
    effects: int,
    X: Vector,
    x: int,
    q: float,
    v: float,
    h: float,
    rounding: float,
) -> tuple[float, float, float]:
    """Torque at (q, v), N m, and its change with position and velocity over a step of h s.

    Positions in single precision are accumulated in double precision: rounding would make a joint
    at rest tremble and creep.

    Args:
        P: block of the law at p, number of effects (none) at `effects`. X: state at x.
        rounding: relative rounding of positions; 0: double precision.
    """
    at = x + ROW
    if X[at + row.STEP] == 0.0:
        X[x + CLOCK] = 0.0
        X[x + PLACE] = q
    else:
        way = q - X[x + SHOWN]
        last = X[x + STEP]
        X[x + CLOCK] = X[x + CLOCK] + last
        if way != 0.0 and rounding > 0.0:
            if abs(way - last * v) <= rounding * abs(q):
                way = last * v
            # our place goes a hundredth of its distance from the position shown
            way = way + 0.01 * (X[x + SHOWN] - X[x + PLACE])
        X[x + PLACE] = X[x + PLACE] + way
    X[x + SHOWN] = q
    X[x + STEP] = h
    F = row.torque_now(P, p, effects, X, at, X[x + CLOCK], X[x + PLACE], v, math.inf)
    if F != F:
        return F, 0.0, 0.0
    since = X[at + row.T_EVALUATED] - X[at + row.T_COMMITTED]
    # as the velocity changed over the last step it is expected to go on
    w = v
    if since > 0.0:
        w = v + (v - X[at + row.V_COMMITTED]) * h / since
    constant, K, D = secant(P, p, X, at + row.FRONT, h, w)
    X[at + row.TORQUE] = constant
    X[at + row.GAIN] = h * K + D
    return constant + D * v, K, D


@compiled
def step_all(
    P: Vector,
    blocks: Index,
    ends: Index,
    X: Vector,
    stride: int,
    q: Vector,
    v: Vector,
    h: float,
    rounding: float,
    torque: Vector,
    stiffness: Vector,
    damping: Vector,
) -> None:
    """`step_joint` for every joint; arrays of shape (n,)."""
    block, state = pointer(P, 0), pointer(X, 0)
    for i in range(len(q)):
        F, K, D = step_joint(block, blocks[i], ends[i], state, i * stride, q[i], v[i], h, rounding)
        torque[i] = F
        stiffness[i] = K
        damping[i] = D
