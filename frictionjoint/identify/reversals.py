"""Reversals between two samples of a grid: friction turns there, and a point of it says not when.

Where a contact is stiff, friction goes from one level to the other within a fraction of a step. A
sample of it just before or just after is wrong by up to both levels for that step. The path of a
law so has further points around a reversal, and what a balance takes of the law is its mean over
each step. Elsewhere point and mean are the same.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import csr_array

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import TIME, Q, V

# points a step around a reversal, and steps before and after that of the reversal
_POINTS, _BEFORE, _AFTER = 8, 1, 2


@dataclass(frozen=True)
class Path:
    """What a law is driven along.

    Attributes:
        time, position: shape (m,), m at least n.
        mean: takes what belongs to those points to the n samples of the grid, shape (n, m); None
            where they are the same.
    """

    time: Array
    position: Array
    mean: csr_array | None

    def on_grid(self, x: Array) -> Array:
        """Mean over each step, along axis 0."""
        return x if self.mean is None else np.asarray(self.mean @ x)


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
        return Path(time, q, None)
    fine = np.zeros(n - 1, dtype=bool)
    for k in range(-_BEFORE, _AFTER + 1):
        fine[np.clip(turns + k, 0, n - 2)] = True
    steps = np.flatnonzero(fine)
    extra = (time[steps, None] + step * np.arange(1, _POINTS) / _POINTS).ravel()
    spline = CubicHermiteSpline(time, q, v)
    all_times = np.concatenate([time, extra])
    order = np.argsort(all_times, kind="stable")
    t, x = all_times[order], np.concatenate([q, spline(extra)])[order]
    return Path(t, x, _mean(t, time, fine))


def _mean(t: Array, grid: Array, fine: Array) -> csr_array:
    """Means over a step by the trapezoidal rule, where it is fine on both sides of its sample.

    Elsewhere the sample itself.
    """
    n = len(grid)
    own = np.searchsorted(t, grid)
    at = np.flatnonzero(np.append(fine, False) & np.append(False, fine))
    half = _POINTS // 2
    rule = np.full(_POINTS + 1, 1.0 / _POINTS)
    rule[[0, -1]] *= 0.5
    plain = np.ones(n)
    plain[at] = 0.0
    rows, columns, weights = [np.arange(n)], [own], [plain]
    for j, weight in enumerate(rule):
        rows.append(at)
        columns.append(own[at] + j - half)
        weights.append(np.full(len(at), weight))
    return csr_array(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))),
        shape=(n, len(t)),
    )
