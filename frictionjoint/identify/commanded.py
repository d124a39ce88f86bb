"""Controller output of a log for a fit: after the filter of the motion.

A fit of a reconstructed drive can compute the output of a changed controller (a dead band, a lower
limit): an effect of the drive changes the drive itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, pointer
from frictionjoint.control.kernel import KD
from frictionjoint.control.profile import last_before
from frictionjoint.control.reconstruct import AllCommands, Commands
from frictionjoint.measured.lowpass import LowPass, LowPasses, places

# from block and delay of a controller to those of another one
Change = Callable[[Array, float], tuple[Array, float]]
# an output of several controllers, given their blocks and delays
Output = Callable[[AllCommands, Array, Array], Array]


@dataclass(frozen=True)
class Commanded:
    """Commands of a log, and the filters that lead to its drive on the uniform grid of a fit, s."""

    commands: Commands
    grid: Array
    filters: tuple[LowPass, ...]

    @property
    def damped(self) -> bool:
        """Whether the controller damps the joint."""
        return bool(self.commands.block[KD])

    def thinned(self, smooth: LowPass) -> "Commanded":
        """The commands on a coarser grid, after one more filter."""
        return replace(self, filters=(*self.filters, smooth))


class CommandedLogs:
    """Commands of several logs, concatenated: one call computes all drives, in which `places` are
    the slices of the logs."""

    def __init__(self, logs: Sequence[Commanded]) -> None:
        self._logs = [log.commands for log in logs]
        self._commands = AllCommands(self._logs)
        self._grid = np.concatenate([log.grid for log in logs])
        self._edges = np.cumsum([0, *(len(log.grid) for log in logs)])
        stages = zip(*(log.filters for log in logs), strict=True)
        self._filters = [LowPasses(filters) for filters in stages]
        self.places = places([log.filters[-1].given for log in logs])

    def output(self, of: Output, changes: Sequence[Change]) -> Array:
        """An output of the controllers of all logs after some changes, on the grids of the fit and
        filtered, shape (n,)."""
        blocks, delays = [], []
        for log in self._logs:
            block, delay = log.block.copy(), log.delay
            for change in changes:
                block, delay = change(block, delay)
            blocks.append(block)
            delays.append(delay)
        made = of(self._commands, np.array(blocks), np.array(delays))
        x = np.empty_like(self._grid)
        _fill_uniform(self._commands.time, made, self._commands.edges, self._grid, self._edges, x)
        rows = x[None]
        for smooth in self._filters:
            rows = smooth(rows)
        return np.asarray(rows[0])


@compiled
def _fill_uniform(
    time: Vector, x: Vector, edges: Index, grid: Vector, grid_edges: Index, out: Vector
) -> None:
    """Fill `out` by linear interpolation between samples, log by log, as `numpy.interp`."""
    for i in range(len(edges) - 1):
        t, y, n = pointer(time, edges[i]), pointer(x, edges[i]), edges[i + 1] - edges[i]
        at, last = 0, n - 1
        for j in range(grid_edges[i], grid_edges[i + 1]):
            at = last_before(t, n, grid[j], at)
            if at == last or grid[j] <= t[0]:
                out[j] = y[at]
            else:
                out[j] = (y[at + 1] - y[at]) / (t[at + 1] - t[at]) * (grid[j] - t[at]) + y[at]
