"""Laws driven along the motion of several logs, from their initial friction states.

One call of a law's kernel serves all logs: for a short log the overhead of a call exceeds the
computation.

At a reversal friction changes sign at an unknown time between two samples. With a stiff contact, it
changes from one level to the other within a fraction of a step, so a sample just before or after is
wrong by up to both levels for that step. So the path of a law has additional points around a
reversal, and the balance uses the law's mean over each step. Elsewhere point and mean agree.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from frictionjoint.arrays import Array, Index
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import TIME, Q, V
from frictionjoint.identify.shape import Shape

# displacements, over the travel, over which friction may have come to what it held at first
_WAY = np.concatenate([[0.0], np.geomspace(1e-7, 3.0, 60)])
# points a step around a reversal
_POINTS = 8
# weights of the points of a mean over a step: the trapezoidal rule
_RULE = np.full(_POINTS + 1, 1.0 / _POINTS)
_RULE[[0, -1]] *= 0.5


@dataclass(frozen=True)
class Path:
    """Path along which a law is driven: m >= n points for the n samples of a grid."""

    time: Array  # shape (m,)
    position: Array  # shape (m,)
    samples: Index  # index of each sample among the points, shape (n,)
    averaged: NDArray[np.bool_]  # whether a sample is the mean over the step around it, shape (n,)


def path_of(signals: Array, resolution: float) -> Path:
    """The path of a log, signals of shape (n, N_SIGNALS) on a uniform grid, with those reversals
    resolved that exceed the resolution of the position."""
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
    """Map values at the points of paths, shape (k, m), to the samples of their grids, (k, n)."""
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


# time and position of motions one after the other, the start of each and the end of the last, and
# the indices of the logs' samples
Motions = tuple[Array, Array, Index, Index]


class Start(NamedTuple):
    """Initial state of a log: friction over Fc, position and travel of the whole log, rad (m)."""

    held: float
    position: float
    travel: float


@dataclass(frozen=True)
class Tracks:
    """Motions of logs along which laws are evaluated, with one path and start per log."""

    paths: tuple[Path, ...]
    starts: tuple[Start, ...]

    def begun(self, held: Array) -> "Tracks":
        """The same motions with other initial frictions over Fc, one per log."""
        pairs = zip(self.starts, held.tolist(), strict=True)
        return replace(self, starts=tuple(start._replace(held=x) for start, x in pairs))

    def along(self, law: Shape) -> Array:
        """H and dz/dq along all logs in order, shape (2, n)."""
        time, q, edges, samples = self._whole(law)
        return self._on_grid(np.stack(law.hysteresis(time, q, edges)), samples)

    def tangents(self, law: Shape, of_rate: bool) -> tuple[Array, Array, Array | None]:
        """`along`, and derivatives of H and, if requested, dz/dq by a law's numbers, (k, n)."""
        time, q, edges, samples = self._whole(law)
        level, rate, dH, drate = law.tangents(time, q, edges)
        moves = self._on_grid(drate, samples) if of_rate else None
        return self._on_grid(np.stack([level, rate]), samples), self._on_grid(dH, samples), moves

    def _on_grid(self, x: Array, samples: Index) -> Array:
        """Rows along whole paths, mapped to the grids of the logs."""
        if x.shape[1] == len(samples):  # no point but those of the grids
            return x
        found = np.empty((len(x), len(samples)))
        fill_grid(x, samples, self._averaged, found)
        return found

    @cached_property
    def _averaged(self) -> NDArray[np.bool_]:
        return np.concatenate([path.averaged for path in self.paths])

    def _whole(self, law: Shape) -> Motions:
        """The motions for a law, each preceded by an approach to its initial friction, if any."""
        held = [i for i, start in enumerate(self.starts) if start.held]
        if not held:
            return self._alone
        ways = _approaches(law, [self.starts[i] for i in held])
        return self._preceded(dict(zip(held, ways, strict=True)))

    @cached_property
    def _alone(self) -> Motions:
        return self._preceded({})

    def _preceded(self, ways: Mapping[int, Array]) -> Motions:
        """The motions, some of them preceded by an approach, by the index of the log."""
        times, positions, edges, samples = [], [], [0], []
        for i, path in enumerate(self.paths):
            way = ways.get(i, np.zeros(0))
            times += [path.time[0] + np.arange(-len(way), 0.0), path.time]
            positions += [way, path.position]
            first = edges[-1] + len(way)
            samples.append(first + path.samples)
            edges.append(first + len(path.time))
        time, q, indices = (np.concatenate(x) for x in (times, positions, samples))
        return time, q, np.array(edges), indices


def _approaches(law: Shape, starts: list[Start]) -> list[Array]:
    """Positions, one second apart, over which a law that never moved reaches the initial friction
    of logs, or its largest: a monotonic approach is assumed, as the motion before is unknown."""
    held = np.array([start.held for start in starts])
    sizes = np.sign(held) * [start.travel or 1.0 for start in starts]
    ways = np.outer(sizes, _WAY)
    seconds = np.tile(np.arange(float(len(_WAY))), len(starts))
    edges = len(_WAY) * np.arange(len(starts) + 1)
    levels = np.abs(law.hysteresis(seconds, ways.ravel(), edges)[0]).reshape(ways.shape)
    found = []
    for start, way, level in zip(starts, ways, levels, strict=True):
        enough = np.flatnonzero(level >= abs(start.held))
        k = max(1, int(enough[0] if enough.size else np.argmax(level)))
        fraction = (abs(start.held) - level[k - 1]) / ((level[k] - level[k - 1]) or 1.0)
        end = way[k - 1] + min(fraction, 1.0) * (way[k] - way[k - 1])
        found.append(start.position - end + way[:k])
    return found
