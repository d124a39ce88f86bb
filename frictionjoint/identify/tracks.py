"""Laws driven along the motion of several logs, from their initial friction states.

One call of a law's kernel serves all logs: for a short log the overhead of a call exceeds the
computation.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Index
from frictionjoint.identify.reversals import Path, fill_grid
from frictionjoint.identify.shape import Shape

# displacements, over the travel, over which friction may have come to what it held at first
_WAY = np.concatenate([[0.0], np.geomspace(1e-7, 3.0, 60)])


class Start(NamedTuple):
    """Initial state of a log.

    Attributes:
        held: friction over Fc. position: rad (m). travel: of the whole log, rad (m).
    """

    held: float
    position: float
    travel: float


@dataclass(frozen=True)
class Tracks:
    """Motions of logs along which laws are evaluated.

    Attributes:
        paths, starts: one per log.
    """

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
        """`along`, and derivatives of H and, if requested, dz/dq by the numbers of a law, (k, n)
        each."""
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
    def _paths(self) -> tuple[Array, Array, Index]:
        """Time, position and edges of the logs themselves."""
        time = np.concatenate([path.time for path in self.paths])
        q = np.concatenate([path.position for path in self.paths])
        return time, q, np.cumsum([0, *(len(path.time) for path in self.paths)])

    @cached_property
    def _averaged(self) -> NDArray[np.bool_]:
        return np.concatenate([path.averaged for path in self.paths])

    def _samples(self, begin: Index) -> Index:
        """Indices of all samples, if the path of each log starts at a given index."""
        parts = zip(self.paths, begin.tolist(), strict=True)
        return np.concatenate([first + path.samples for path, first in parts])

    @cached_property
    def _own_samples(self) -> Index:
        """Indices of the samples if no log is preceded by an approach."""
        return self._samples(self._paths[2][:-1])

    def _whole(self, law: Shape) -> tuple[Array, Array, Index, Index]:
        """Time, position and edges of the motions for a law, and the indices of the logs' samples.

        A log with initial friction is preceded by an approach to that friction.
        """
        time, q, edges = self._paths
        held = [i for i, start in enumerate(self.starts) if start.held]
        if not held:
            return time, q, edges, self._own_samples
        before = dict(zip(held, _approaches(law, [self.starts[i] for i in held]), strict=True))
        times, positions, begin, lengths = [], [], [], [0]
        for i, path in enumerate(self.paths):
            way = before.get(i, np.zeros(0))
            times += [path.time[0] + np.arange(-len(way), 0.0), path.time]
            positions += [way, path.position]
            begin.append(len(way))
            lengths.append(len(way) + len(path.time))
        edges = np.cumsum(lengths)
        samples = self._samples(edges[:-1] + begin)
        return np.concatenate(times), np.concatenate(positions), edges, samples


def _approaches(law: Shape, starts: list[Start]) -> list[Array]:
    """Positions, one second apart, over which a law that never moved reaches the initial friction
    of logs.

    The motion before a log is unknown; a monotonic approach is assumed. A law that cannot reach the
    friction is brought to its largest.
    """
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
