"""One entry to all laws: a block of parameters says which law it is, a row of state belongs to it.

Parameter block ``P[p:]``: the number of the law, then the law's own numbers (its module says
which). State row ``X[x:]``: the committed header, the header of the last evaluation, the stacks.
`step_row` evaluates from the committed header as often as asked; `commit` makes the last
evaluation the new starting point.
"""

from numba import njit

from frictionjoint.law import integrated
from frictionjoint.law.memory import CAPACITY, FH, HEADER, make_room
from frictionjoint.law.stribeck import FC

INTEGRATED = 1

_start_integrated = integrated.start
_step_integrated = integrated.step


@njit(cache=True)
def row_size(P, p):
    """Number of float64 a joint's state takes."""
    return 2 * HEADER + 2 * CAPACITY


@njit(cache=True)
def start_row(P, p, X, x):
    """At rest and never moved."""
    _start_integrated(P, p + 1, X, x, x + 2 * HEADER)
    for i in range(HEADER):
        X[x + HEADER + i] = X[x + i]


@njit(cache=True)
def step_row(P, p, X, x, dq, dt, v):
    """Torque after a displacement from the committed point; leaves the committed point alone."""
    return _step_integrated(P, p + 1, X, x, x + HEADER, x + 2 * HEADER, dq, dt, v)


@njit(cache=True)
def commit(P, p, X, x):
    """The last evaluated point becomes the committed one."""
    for i in range(HEADER):
        X[x + i] = X[x + HEADER + i]
    make_room(X, x, x + 2 * HEADER)


@njit(cache=True)
def hysteresis_torque(P, p, X, x):
    """Fh of the last evaluation, N m."""
    return X[x + HEADER + FH]


@njit(cache=True)
def coulomb_level(P, p):
    """Mean of the two directions' Coulomb torques, N m."""
    return 0.5 * (P[p + 1 + integrated.POSITIVE + FC] + P[p + 1 + integrated.NEGATIVE + FC])
