"""Tangents: derivatives of a number in several directions of the parameters at once.

Each number of a kernel that depends on parameters has a tangent, with one entry per direction. The
number of directions is small and fixed, so that a tangent fits into registers. One pass over a
motion then evaluates exponentials and branches once for all directions.

The functions below are the operations that `frictionjoint.law.tangents.generate` uses.
"""

from typing import TypeAlias

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line

Tangent: TypeAlias = tuple[float, float, float, float, float, float]
ZERO: Tangent = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
DIRECTIONS = len(ZERO)


@in_line
def at(X_t: Vector, i: int) -> Tangent:
    """Tangent of X[i]; those of an array stand one behind the other."""
    k = DIRECTIONS * i
    return (X_t[k], X_t[k + 1], X_t[k + 2], X_t[k + 3], X_t[k + 4], X_t[k + 5])


@in_line
def put(X_t: Vector, i: int, x: Tangent) -> None:
    """Set the tangent of X[i]."""
    k = DIRECTIONS * i
    X_t[k], X_t[k + 1], X_t[k + 2], X_t[k + 3], X_t[k + 4], X_t[k + 5] = x


@in_line
def scaled(a: float, x: Tangent) -> Tangent:
    """a x."""
    return (a * x[0], a * x[1], a * x[2], a * x[3], a * x[4], a * x[5])


@in_line
def sum2(a: float, x: Tangent, b: float, y: Tangent) -> Tangent:
    """a x + b y."""
    return (
        a * x[0] + b * y[0],
        a * x[1] + b * y[1],
        a * x[2] + b * y[2],
        a * x[3] + b * y[3],
        a * x[4] + b * y[4],
        a * x[5] + b * y[5],
    )
