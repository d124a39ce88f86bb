"""Several logs of a fit as one: what a search asks of all of them is one call of a kernel each.

To ask for what is done to a short log takes longer than to do it, and while it is asked for no
other thread goes on.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, A, V
from frictionjoint.identify.commanded import Change, Commanded, CommandedLogs
from frictionjoint.identify.reversals import Path
from frictionjoint.identify.store import Store
from frictionjoint.identify.tracks import Start, Tracks
from frictionjoint.measured.lowpass import LowPass, LowPasses, Spectrum, places


class Log(Protocol):
    """What a bundle asks of a log, see `segment.Segment`."""

    @property
    def path(self) -> Path:
        """Time and position that a law is driven along."""

    @property
    def start(self) -> Start:
        """How it begins."""

    @property
    def filter(self) -> LowPass:
        """That the balance passes."""

    @property
    def kept(self) -> NDArray[np.bool_]:
        """The samples behind it that a fit keeps."""

    @property
    def signals(self) -> Array:
        """Of the motion, shape (n, N_SIGNALS)."""

    @property
    def drive(self) -> Array:
        """As measured or made by a controller, shape (n,)."""

    @property
    def commanded(self) -> Commanded | None:
        """What its controller made the drive of."""


# bytes of what searches made of the logs that are kept: most of it stays from one point of a search
# to the next, and where one search ends others begin
_KEPT = 12_000_000

_Log = TypeVar("_Log", bound=Log)
# drives of the logs with each filter
Spectra = list[Spectrum]


class Bundle(Generic[_Log]):
    """Logs one behind the other.

    Attributes:
        logs: at least one. places: of each among the n samples of all.
        store: columns and targets of balances, and laws along the logs.
    """

    def __init__(self, logs: Sequence[_Log]) -> None:
        self.logs = tuple(logs)
        self.places = places([len(log.drive) for log in logs])
        self._filters = LowPasses([log.filter for log in logs])
        self._kept = np.concatenate([log.kept for log in logs])
        self.store = Store(_KEPT)

    @cached_property
    def tracks(self) -> Tracks:
        """Motions along which laws are evaluated."""
        paths, starts = zip(*((log.path, log.start) for log in self.logs), strict=True)
        return Tracks(paths, starts)

    def kept(self, x: Array) -> Array:
        """What the balance keeps of signals in rows, shape (k, n), as columns, shape (m, k)."""
        return np.asarray(self._filters(x)[:, self._kept].T)

    def row(self, signal: int) -> Array:
        """A signal of all logs, shape (n,)."""
        return np.concatenate([log.signals[:, signal] for log in self.logs])

    @cached_property
    def velocity(self) -> Array:
        """Of all samples, rad/s, shape (n,)."""
        return self.row(V)

    @cached_property
    def load_and_velocity(self) -> Array:
        """Torque of the rigid body, N m, and velocity, rad/s, as the balance keeps them, (m, 2)."""
        return self.kept(np.stack([self.row(LOAD), self.velocity]))

    @cached_property
    def rate(self) -> Array:
        """Acceleration as the balance keeps it, rad/s^2, shape (m,)."""
        return self.kept(self.row(A)[None])[:, 0]

    def balanced(self, spectra: Spectra, delay: float = 0.0, derivative: int = 0) -> Array:
        """Drives as they were `delay` seconds before each sample that the balance keeps, (m,)."""
        return np.asarray(self._filters.back(spectra, derivative, delay)[0, self._kept])

    @cached_property
    def driven(self) -> Spectra:
        """The drives of the logs."""
        return self._filters.spectra(np.concatenate([log.drive for log in self.logs])[None])

    def changed(self, changes: Sequence[Change]) -> Spectra:
        """Drives that their controllers make with some changes, one after the other."""
        if not changes or self._commanded is None:
            return self.driven
        drive = np.concatenate([log.drive for log in self.logs])
        self._put(self._commanded.drive(changes), drive)
        return self._filters.spectra(drive[None])

    def answer(self, changes: Sequence[Change]) -> Array:
        """How much of such drives a small error of the position calls for, per rad (m), (m,).

        Zero where the drive is measured.
        """
        found = np.zeros_like(self.velocity)
        if self._commanded is not None:
            self._put(self._commanded.answer(changes), found)
        return self.kept(found[None])[:, 0]

    def damping_rate(self, changes: Sequence[Change]) -> Array:
        """Rate of the damping that is in such drives, in units of the drive per s, (m,)."""
        return self._damping_rate_of(changes) if changes else self._damping_rate

    @cached_property
    def _damping_rate(self) -> Array:
        """Of the drives as they are: every search of a controller's log asks for it."""
        return self._damping_rate_of(())

    def _damping_rate_of(self, changes: Sequence[Change]) -> Array:
        found = np.zeros_like(self.velocity)
        if self._commanded is not None:
            self._put(self._commanded.damping(changes), found)
        return self.kept((found * self.row(A))[None])[:, 0]

    def _put(self, made: Array, all_logs: Array) -> None:
        """What controllers made, in the places of their logs."""
        commanded = [i for i, log in enumerate(self.logs) if log.commanded is not None]
        assert self._commanded is not None
        for i, own in zip(commanded, self._commanded.places, strict=True):
            # a log may have been cut off since
            all_logs[self.places[i]] = made[own][: len(self.logs[i].drive)]

    @cached_property
    def _commanded(self) -> CommandedLogs | None:
        logs = [log.commanded for log in self.logs if log.commanded is not None]
        return CommandedLogs(logs) if logs else None
