"""Concatenated logs, so that each kernel is called once for all logs.

For a short log, a call takes longer than the computation and blocks other threads. Of a
reconstructed drive the logs contain the commands: an effect of the drive (a dead band, a lower
limit) changes the drive itself, so a fit computes the output of the changed controller.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import KD
from frictionjoint.control.reconstruct import AllCommands, Commands
from frictionjoint.effects.signals import LOAD, A, V
from frictionjoint.identify.tracks import Tracks
from frictionjoint.measured.lowpass import LowPass, LowPasses, Spectrum, places

if TYPE_CHECKING:  # a prepared log bundles what it is made of
    from frictionjoint.identify.segment import Segment

# from block and delay of a controller to those of another one
Change = Callable[[Array, float], tuple[Array, float]]
# an output of several controllers, given their blocks and delays
Output = Callable[[AllCommands, Array, Array], Array]


def changed_controller(
    changes: Sequence[Change], block: Array, delay: float
) -> tuple[Array, float]:
    """Block and delay of a controller after some changes in order."""
    block = block.copy()
    for change in changes:
        block, delay = change(block, delay)
    return block, delay


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
    """Commands of several logs: one call computes all drives, with the logs' slices in `places`."""

    def __init__(self, logs: Sequence[Commanded]) -> None:
        self._logs = [log.commands for log in logs]
        self._commands = AllCommands(self._logs)
        self._grids = [log.grid for log in logs]
        stages = zip(*(log.filters for log in logs), strict=True)
        self._filters = [LowPasses(filters) for filters in stages]
        self.places = places([log.filters[-1].given for log in logs])

    def output(self, of: Output, changes: Sequence[Change]) -> Array:
        """An output of all logs' controllers after changes, filtered on the fit's grids, (n,)."""
        pairs = (changed_controller(changes, log.block, log.delay) for log in self._logs)
        blocks, delays = zip(*pairs, strict=True)
        made = of(self._commands, np.array(blocks), np.array(delays))
        parts = np.split(made, self._commands.edges[1:-1])
        each = zip(self._grids, self._logs, parts, strict=True)
        rows = np.concatenate([np.interp(grid, log.time, x) for grid, log, x in each])[None]
        for smooth in self._filters:
            rows = smooth(rows)
        return np.asarray(rows[0])


# drives of the logs with each filter
Spectra = list[Spectrum]


class Cache:
    """Least-recently-used cache of arrays by key, of at most so many bytes.

    Threads may use it in parallel. It is not passed to other processes.
    """

    def __init__(self, most: int) -> None:
        self._most, self._held = most, 0
        self._found: OrderedDict[object, NDArray[Any]] = OrderedDict()
        self._lock = Lock()

    def __reduce__(self) -> tuple[type["Cache"], tuple[int]]:
        return Cache, (self._most,)

    def get(self, key: object, make: Callable[[], NDArray[Any]]) -> NDArray[Any]:
        """The array of a key, computed if necessary; it must not be changed."""
        with self._lock:
            if key in self._found:
                self._found.move_to_end(key)
                return self._found[key]
        made = make()
        with self._lock:
            if key not in self._found:
                self._found[key] = made
                self._held += made.nbytes
            while self._held > self._most and len(self._found) > 1:
                self._held -= self._found.popitem(last=False)[1].nbytes
        return made


class Bundle:
    """Concatenated logs, at least one."""

    def __init__(self, logs: Sequence["Segment"]) -> None:
        self.logs = tuple(logs)
        # slice of each log among the n samples of all
        self.places = places([len(log.drive) for log in logs])
        self._filters = LowPasses([log.filter for log in logs])
        self._kept = np.concatenate([log.kept for log in logs])
        # columns and targets of balances, and laws along the logs; most serve the next point of a
        # search, or the next search
        self.store = Cache(max(12_000_000, 30 * self.velocity.nbytes))

    @cached_property
    def tracks(self) -> Tracks:
        """Motions along which laws are evaluated."""
        paths, starts = zip(*((log.path, log.start) for log in self.logs), strict=True)
        return Tracks(paths, starts)

    def kept(self, x: Array) -> Array:
        """Signals in rows, shape (k, n), filtered, as columns on the kept samples, shape (m, k)."""
        return np.asarray(self._filters(x)[:, self._kept].T)

    def row(self, signal: int) -> Array:
        """A signal of all logs, shape (n,)."""
        return np.concatenate([log.signals[:, signal] for log in self.logs])

    @cached_property
    def velocity(self) -> Array:
        """Velocity at all samples, rad/s, shape (n,)."""
        return self.row(V)

    @cached_property
    def load_and_velocity(self) -> Array:
        """Rigid-body torque, N m, and velocity, rad/s, on the kept samples, (m, 2)."""
        return self.kept(np.stack([self.row(LOAD), self.velocity]))

    @cached_property
    def rate(self) -> Array:
        """Acceleration on the kept samples, rad/s^2, shape (m,)."""
        return self.kept(self.row(A)[None])[:, 0]

    def balanced(self, spectra: Spectra, delay: float = 0.0, derivative: int = 0) -> Array:
        """Drives `delay` seconds before each kept sample, (m,)."""
        return np.asarray(self._filters.back(spectra, derivative, delay)[0, self._kept])

    @cached_property
    def driven(self) -> Spectra:
        """The drives of the logs."""
        return self._filters.spectra(np.concatenate([log.drive for log in self.logs])[None])

    def changed(self, changes: Sequence[Change]) -> Spectra:
        """Drives of controllers with some changes applied in order."""
        if not changes or self._commanded is None:
            return self.driven
        drive = np.concatenate([log.drive for log in self.logs])
        return self._filters.spectra(self._put(AllCommands.mean_drive, changes, drive)[None])

    def answer(self, changes: Sequence[Change]) -> Array:
        """Change of the controllers' drives per small error of position, see `Balance.answer`."""
        found = self._put(AllCommands.answer, changes, np.zeros_like(self.velocity))
        return self.kept(found[None])[:, 0]

    def damping_rate(self, changes: Sequence[Change]) -> Array:
        """Rate of the damping part of the controllers' drives, in drive units per s, (m,)."""
        found = self._put(AllCommands.damping, changes, np.zeros_like(self.velocity))
        return self.kept((found * self.row(A))[None])[:, 0]

    def _put(self, output: Output, changes: Sequence[Change], all_logs: Array) -> Array:
        """Values of all logs, with outputs of changed controllers in the slices of their logs."""
        if self._commanded is None:
            return all_logs
        made = self._commanded.output(output, changes)
        commanded = [i for i, log in enumerate(self.logs) if log.commanded is not None]
        for i, own in zip(commanded, self._commanded.places, strict=True):
            # a log may have been cut off since
            all_logs[self.places[i]] = made[own][: len(self.logs[i].drive)]
        return all_logs

    @cached_property
    def _commanded(self) -> CommandedLogs | None:
        logs = [log.commanded for log in self.logs if log.commanded is not None]
        return CommandedLogs(logs) if logs else None
