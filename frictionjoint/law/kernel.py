"""One entry to all laws: a block of parameters says which law it is, a row of state belongs to it.

Parameter block ``P[p:]``: the number of the law, then the law's own numbers (its module says
which). State row ``X[x:]``: the committed header, the header of the last evaluation, and for the
integrated law the stacks. `step_row` evaluates from the committed header as often as asked;
`commit` makes the last evaluation the new starting point.

A kernel knows no table of functions, hence the chains of comparisons; the integrated law comes
first in each.
"""

import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line, room
from frictionjoint.law import (
    armstrong,
    bristle,
    dahl,
    elastoplastic,
    integrated,
    lugre,
    maxwell_slip,
    static,
)
from frictionjoint.law.memory import CAPACITY, FH, HEADER, N_MAX, N_MIN, RATE, make_room
from frictionjoint.law.stribeck import FC, FS

INTEGRATED, STATIC, ARMSTRONG, DAHL, LUGRE, ELASTOPLASTIC, MAXWELL_SLIP, DAHL_STRIBECK = range(1, 9)


@compiled
def header_size(P: Vector, p: int) -> int:
    """Length of the committed header of a row; the header of the last evaluation follows it."""
    if P[p] == INTEGRATED:
        return HEADER
    if P[p] == MAXWELL_SLIP:
        return maxwell_slip.size(P, p + 1)
    if P[p] == ARMSTRONG:
        return armstrong.SIZE
    if P[p] == DAHL_STRIBECK:
        return dahl.STRIBECK_SIZE
    return bristle.HEADER


@compiled
def row_size(P: Vector, p: int) -> int:
    """Number of float64 a joint's state takes."""
    return 2 * header_size(P, p) + (2 * CAPACITY if P[p] == INTEGRATED else 0)


@compiled
def start_row(P: Vector, p: int, X: Vector, x: int) -> None:
    """Set a row to a joint that is at rest and has never moved."""
    if P[p] == INTEGRATED:
        integrated.start(P, p + 1, X, x, x + 2 * HEADER)
        for i in range(HEADER):
            X[x + HEADER + i] = X[x + i]
        return
    n = header_size(P, p)
    for i in range(2 * n):
        X[x + i] = 0.0
    # bristles at rest follow the motion one to one; the static law has none
    if P[p] != STATIC:
        X[x + bristle.RATE] = 1.0
        X[x + n + bristle.RATE] = 1.0


@compiled
def step_rival(
    P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float
) -> float:
    """A step of any law but the integrated one, from header `a` to header `h` (may be `a`)."""
    law = int(P[p])
    if law == LUGRE:
        return lugre.step(P, p + 1, X, a, h, dq, dt, v)
    if law == MAXWELL_SLIP:
        return maxwell_slip.step(P, p + 1, X, a, h, dq, dt, v)
    if law == ELASTOPLASTIC:
        return elastoplastic.step(P, p + 1, X, a, h, dq, dt, v)
    if law == DAHL:
        return dahl.step(P, p + 1, X, a, h, dq, dt, v)
    if law == DAHL_STRIBECK:
        return dahl.stribeck_step(P, p + 1, X, a, h, dq, dt, v)
    if law == ARMSTRONG:
        return armstrong.step(P, p + 1, X, a, h, dq, dt, v)
    if law == STATIC:
        return static.step(P, p + 1, X, a, h, dq, dt, v)
    return np.nan


@compiled
def hold_rival(
    P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float
) -> float:
    """`step_rival` in a simulation, where the static law has an elastic element."""
    if P[p] == STATIC:
        return static.elastic_step(P, p + 1, X, a, h, dq, dt, v)
    return step_rival(P, p, X, a, h, dq, dt, v)


@in_line
def step_row(P: Vector, p: int, X: Vector, x: int, dq: float, dt: float, v: float) -> float:
    """Torque after a displacement from the committed point, which is not changed."""
    if P[p] == INTEGRATED:
        return integrated.step(P, p + 1, X, x, x + HEADER, x + 2 * HEADER, dq, dt, v)
    return step_rival(P, p, X, x, x + header_size(P, p), dq, dt, v)


@in_line
def hold_row(P: Vector, p: int, X: Vector, x: int, dq: float, dt: float, v: float) -> float:
    """`step_row` for a simulation, in which every law can hold a joint at rest."""
    if P[p] == INTEGRATED:
        return integrated.step(P, p + 1, X, x, x + HEADER, x + 2 * HEADER, dq, dt, v)
    return hold_rival(P, p, X, x, x + header_size(P, p), dq, dt, v)


@compiled
def trial(
    P: Vector, p: int, X: Vector, x: int, dq: float, dt: float, v: float
) -> tuple[float, float]:
    """Fh, N m, and dz/dq after a further displacement, in a simulation; the row is not changed.

    The row needs a free slot on each stack.
    """
    if P[p] == INTEGRATED:
        h, s = x + HEADER, x + 2 * HEADER
        # a reversal writes above the top, where the committed stack may go on
        low = s + int(X[h + N_MIN])
        high = s + CAPACITY + int(X[h + N_MAX])
        minimum, maximum = X[low], X[high]
        kept = room(HEADER)
        for i in range(HEADER):
            kept[i] = X[h + i]
        integrated.step(P, p + 1, X, h, h, s, dq, dt, v)
        Fh, rate = X[h + FH], X[h + RATE]
        for i in range(HEADER):
            X[h + i] = kept[i]
        X[low] = minimum
        X[high] = maximum
        return Fh, rate
    n = header_size(P, p)
    h = x + n
    kept = room(n)
    for i in range(n):
        kept[i] = X[h + i]
    hold_rival(P, p, X, h, h, dq, dt, v)
    Fh, rate = X[h + bristle.FH], X[h + bristle.RATE]
    for i in range(n):
        X[h + i] = kept[i]
    return Fh, rate


@in_line
def commit(P: Vector, p: int, X: Vector, x: int) -> None:
    """Make the last evaluated point the committed one."""
    n = header_size(P, p)
    for i in range(n):
        X[x + i] = X[x + n + i]
    if P[p] == INTEGRATED:
        make_room(X, x, x + 2 * HEADER)


@compiled
def _fit_rival(P: Vector, p: int, X: Vector, x: int) -> None:
    """`fit_row` for any law but the integrated one."""
    Fh = X[x + bristle.FH]
    way = 1.0 if Fh > 0.0 else -1.0
    most = P[bristle.side(p + 1, way) + FS]
    if abs(Fh) <= most:
        return
    X[x + bristle.FH] = way * most
    if P[p] == MAXWELL_SLIP:
        for i in range(int(P[p + 1 + maxwell_slip.N_ELEMENTS])):
            X[x + bristle.HEADER + i] *= most / abs(Fh)


@in_line
def fit_row(P: Vector, p: int, X: Vector, x: int) -> None:
    """Limit the committed torque to the breakaway torque, which may have been changed."""
    if P[p] == INTEGRATED:
        s, first = x + 2 * HEADER, p + 1
        if (
            X[s] != -P[first + integrated.NEGATIVE + FS]
            or X[s + CAPACITY] != P[first + integrated.POSITIVE + FS]
        ):
            integrated.set_limits(P, first, X, x, s)
        return
    _fit_rival(P, p, X, x)


@compiled
def hysteresis_torque(P: Vector, p: int, X: Vector, x: int) -> float:
    """Fh of the last evaluation, N m: the friction torque without its viscous and sigma1 parts."""
    return X[x + header_size(P, p) + FH]  # each law's header begins with it


@in_line
def levels_at(P: Vector, p: int) -> int:
    """Index of sigma1; from there to the levels any law's block is laid out as in `bristle`."""
    return p + 1 + (integrated.SIGMA1 if P[p] == INTEGRATED else 0)


@compiled
def coulomb_level(P: Vector, p: int) -> float:
    """Mean of the two directions' Coulomb torques, N m."""
    first = levels_at(P, p)
    return 0.5 * (P[first + bristle.POSITIVE + FC] + P[first + bristle.NEGATIVE + FC])


@compiled
def presliding(P: Vector, p: int) -> tuple[float, float]:
    """Largest stiffness, N m/rad, and damping, N m s/rad, before sliding, in a simulation."""
    law = int(P[p])
    if law == INTEGRATED:
        return P[p + 1 + integrated.KNOTS + 3], P[p + 1 + integrated.SIGMA1]
    if law == STATIC:
        return static.stiffness(P, p + 1), 0.0
    if law == MAXWELL_SLIP:
        K = 0.0
        for i in range(int(P[p + 1 + maxwell_slip.N_ELEMENTS])):
            K += P[p + 1 + maxwell_slip.ELEMENTS + 2 * i]
        return K, 0.0
    K = P[p + 1 + bristle.OWN]
    if P[p] == DAHL or P[p] == DAHL_STRIBECK:
        K *= 2.0 ** P[p + 1 + bristle.OWN + 1]
    return K, P[p + 1 + bristle.SIGMA1]
