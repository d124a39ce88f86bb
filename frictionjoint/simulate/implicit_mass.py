"""The mass matrix that makes friction implicit.

Over a step friction is c + G w, with w the velocity at the step's end. That is MuJoCo's own step
with the passive force -(c + G v) and h G more on the joint's diagonal entry of ``mjData.M``.

MuJoCo makes M anew in each position stage, and the callback may run several times on one. So a
joint's row holds the entry as MuJoCo made it (BASE) and as the callback wrote it (WRITTEN): an
entry that still has the written value becomes the base again before the next evaluation.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line
from frictionjoint.simulate.row import BASE, GAIN, WRITTEN


@in_line
def take_back(X: Vector, x: int, M: Vector, entry: int) -> None:
    """Restore M[entry] without friction; the row X[x:] stores the entry of the factors."""
    found = M[entry]
    if found == X[x + WRITTEN]:
        M[entry] = X[x + BASE]
    X[x + BASE] = M[entry]
    X[x + WRITTEN] = found


@in_line
def put_in(X: Vector, x: int, M: Vector, entry: int, h: float) -> bool:
    """Add friction of a step of h s to M[entry]; returns whether M must be factored again."""
    new = X[x + BASE] + h * X[x + GAIN]
    M[entry] = new
    changed = new != X[x + WRITTEN]
    X[x + WRITTEN] = new
    return bool(changed)
