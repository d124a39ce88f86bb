"""Reversals between two samples, where friction changes sign at an unknown time.

With a stiff contact, friction changes from one level to the other within a fraction of a step. A
sample just before or after is wrong by up to both levels for that step. So the path of a law has
additional points around a reversal, and the balance uses the law's mean over each step. Elsewhere
point and mean agree.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from frictionjoint.arrays import Array, Index
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import TIME, Q, V

# points a step around a reversal
_POINTS = 8
# weights of the points of a mean over a step: the trapezoidal rule
_RULE = np.full(_POINTS + 1, 1.0 / _POINTS)
_RULE[[0, -1]] *= 0.5


@dataclass(frozen=True)
class Path:
    """Path along which a law is driven.

    Attributes:
        time, position: shape (m,), m at least n.
        samples: indices among those points of the n samples of the grid.
        averaged: shape (n,), whether a sample is the mean over the step around it.
    """

    time: Array
    position: Array
    samples: Index
    averaged: NDArray[np.bool_]


def path_of(signals: Array, resolution: float) -> Path:
    """The path of a log with its reversals resolved.

    Args:
        signals: shape (n, N_SIGNALS), on a uniform grid.
        resolution: of the position: reversals within it are not resolved.
    """
    time, q, v = (np.ascontiguousarray(signals[:, k]) for k in (TIME, Q, V))
    n = len(time)
    step = (time[-1] - time[0]) / max(n - 1, 1)
    # displacement from a reversal in the middle of a step to the step's end
    moved = np.abs(np.diff(v)) * step / 8.0
    turns = np.flatnonzero((v[:-1] * v[1:] < 0.0) & (moved > resolution))
    if not len(turns):
        return Path(time, q, np.arange(n), np.zeros(n, dtype=bool))
    fine = np.zeros(n - 1, dtype=bool)
    # one step before that of the reversal, and two after it
    for k in range(-1, 3):
        fine[np.clip(turns + k, 0, n - 2)] = True
    steps = np.flatnonzero(fine)
    extra = (time[steps, None] + step * np.arange(1, _POINTS) / _POINTS).ravel()
    spline = CubicHermiteSpline(time, q, v)
    all_times = np.concatenate([time, extra])
    order = np.argsort(all_times, kind="stable")
    t, x = all_times[order], np.concatenate([q, spline(extra)])[order]
    averaged = np.append(fine, False) & np.append(False, fine)
    return Path(t, x, np.searchsorted(t, time), averaged)


@compiled
def fill_grid(x: Array, samples: Index, averaged: NDArray[np.bool_], out: Array) -> None:
    """Map values at the points of paths to the samples of their grids.

    Args:
        x: rows, shape (k, m). samples, averaged: see `Path`. out: shape (k, n).
    """
    for i in range(len(x)):
        for j in range(len(samples)):
            at = samples[j]
            if averaged[j]:
                total = 0.0
                for k in range(len(_RULE)):
                    total += _RULE[k] * x[i, at + k - _POINTS // 2]
                out[i, j] = total
            else:
                out[i, j] = x[i, at]
