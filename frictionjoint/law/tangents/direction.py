"""Tangents: derivatives of a number in several directions of the parameters at once.

Each number of a kernel that depends on parameters has a tangent, with one entry per direction. The
number of directions is small and fixed, so that a tangent fits into registers. One pass over a
motion then evaluates exponentials and branches once for all directions.

The functions below are the operations that `frictionjoint.law.tangents.generate` uses.
"""

from typing import Annotated, TypeAlias

from frictionjoint.arrays import Array
from frictionjoint.compiled import in_line

Tangent: TypeAlias = tuple[float, float, float, float, float, float]
ZERO: Tangent = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
DIRECTIONS = len(ZERO)
# tangents of an array, shape (its length, DIRECTIONS)
Tangents: TypeAlias = Annotated[Array, "rows of", DIRECTIONS]


@in_line
def at(X_t: Tangents, i: int) -> Tangent:
    """Tangent of X[i]."""
    return (X_t[i, 0], X_t[i, 1], X_t[i, 2], X_t[i, 3], X_t[i, 4], X_t[i, 5])


@in_line
def put(X_t: Tangents, i: int, x: Tangent) -> None:
    """Set the tangent of X[i]."""
    X_t[i, 0], X_t[i, 1], X_t[i, 2], X_t[i, 3], X_t[i, 4], X_t[i, 5] = x


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
