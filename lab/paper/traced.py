"""The law driven along a motion, with what its memory does: for figures of presliding."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.law.memory import FB, FH, N_MAX, N_MIN
from frictionjoint.parameters import Friction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Traced:
    """Arrays of shape (n,): position rad, Fh and its base Fb in N m, sizes of both stacks."""

    position: Array
    Fh: Array
    Fb: Array
    extrema: Array
    F: Array


def trace(p: Friction, turns: list[float], speed: float = 1e-5, per_leg: int = 400) -> Traced:
    """Drive a joint that never moved through turning points, rad, at constant speed, rad/s."""
    q = np.concatenate(
        [[turns[0]], *(np.linspace(a, b, per_leg + 1)[1:] for a, b in itertools.pairwise(turns))]
    )
    P = p.pack()
    X = np.zeros(row_size(P, 0))
    start_row(P, 0, X, 0)
    out = np.zeros((4, len(q)))
    out[2, 0] = 2
    for k in range(1, len(q)):
        dq = q[k] - q[k - 1]
        out[3, k] = step_row(P, 0, X, 0, dq, abs(dq) / speed, np.sign(dq) * speed)
        commit(P, 0, X, 0)
        out[:3, k] = X[FH], X[FB], X[N_MIN] + X[N_MAX]
    return Traced(q, *out)
