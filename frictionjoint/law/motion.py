"""A law driven along a given motion: the friction torque at each sample, from rest."""

import numpy as np
from numpy.typing import ArrayLike

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, pointer, room
from frictionjoint.errors import LogError
from frictionjoint.law import bristle, integrated
from frictionjoint.law.kernel import INTEGRATED, commit, row_size, start_row, step_rival, step_row
from frictionjoint.law.memory import FH, HEADER, RATE, make_room
from frictionjoint.laws import require_parameters
from frictionjoint.parameters import Friction


@compiled
def drive(P: Vector, time: Vector, position: Vector, F: Vector) -> None:
    """Fill F with the torque along a motion that is linear between samples.

    The velocity of sample k is the mean over the interval that ends there, and zero at the first
    one.
    """
    block, p, x = pointer(P, 0), 0, 0
    X = room(row_size(block, p))
    start_row(block, p, X, x)
    F[0] = 0.0
    for k in range(1, len(position)):
        dq = position[k] - position[k - 1]
        dt = time[k] - time[k - 1]
        F[k] = step_row(block, p, X, x, dq, dt, dq / dt)
        commit(block, p, X, x)


@compiled
def drive_motions(
    P: Vector, time: Vector, position: Vector, edges: Index, H: Vector, rate: Vector
) -> None:
    """Fill H with Fh and `rate` with dz/dq along motions, for a block of any law.

    The motions are concatenated: the i-th begins at edges[i] and ends before edges[i + 1]. Each
    starts at rest with a contact that has never moved.
    """
    block, s = pointer(P, 0), 2 * HEADER
    X = room(row_size(block, 0))
    slip = RATE if P[0] == INTEGRATED else bristle.RATE
    for i in range(len(edges) - 1):
        first = edges[i]
        start_row(block, 0, X, 0)
        H[first] = 0.0
        rate[first] = X[slip]
        for k in range(first + 1, edges[i + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            if P[0] == INTEGRATED:
                integrated.step(block, 1, X, 0, 0, s, dq, dt, dq / dt)
                make_room(X, 0, s)
            else:
                step_rival(block, 0, X, 0, 0, dq, dt, dq / dt)
            H[k] = X[FH]
            rate[k] = X[slip]


# quoted: a signature shows the names of these types, not what they stand for
def friction_torque(parameters: Friction, time: "ArrayLike", position: "ArrayLike") -> "Array":
    """Friction torque along a motion, starting at rest and never moved.

    The motion is linear between the samples, so the velocity of an interval is its mean velocity,
    and the torque of a sample is that at the end of its interval (zero at the first sample).

    Args:
        parameters: of any law in this package.
        time: shape (n,), s, strictly increasing.
        position: shape (n,), rad (m for a slide joint).
    Returns:
        shape (n,), N m (N for a slide joint), positive against positive motion.
    Raises:
        LogError: the arrays differ in length, are not finite, or time does not increase.
        TypeError: no parameters, or arrays of something else than numbers.
    """
    require_parameters(parameters, "friction_torque")
    t, q = _numbers("time", time), _numbers("position", position)
    if t.ndim != 1 or t.shape != q.shape:
        raise LogError(f"time {t.shape} and position {q.shape} must be 1-D and of one length")
    if t.size == 0:
        return np.zeros(0)
    for name, x in (("time", t), ("position", q)):
        bad = np.flatnonzero(~np.isfinite(x))
        if bad.size:
            raise LogError(f"{name}[{bad[0]}] is {x[bad[0]]}: give finite values")
    bad = np.flatnonzero(np.diff(t) <= 0.0)
    if bad.size:
        raise LogError(f"time[{bad[0] + 1}] does not increase: sort or remove repeated samples")
    F = np.empty_like(q)
    drive(parameters.pack(), t, q, F)
    return F


def presliding_distance(parameters: Friction, part: float) -> float:
    """Displacement behind a reversal until friction has made a part of its change, rad (m).

    Args:
        part: of the change from one direction of sliding to the other, 0 to 1.
    """
    x = np.geomspace(1e-9, 1.0, 2000)
    q = np.concatenate([[0.0], x, x[-1] - x])
    # at 1e-6 rad/s no law has a viscous part
    F = friction_torque(parameters, np.arange(len(q)) / 1e-6, q)
    back = F[len(x) + 1 :]
    return float(x[np.argmax(back <= F[len(x)] + part * (back[-1] - F[len(x)]))])


def _numbers(name: str, values: ArrayLike) -> Array:
    try:
        return np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is no array of numbers: give one of shape (n,)") from None
