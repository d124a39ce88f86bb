"""A log as a fit works on it: smooth motion, rigid-body torque, signals, on one grid.

Motion and drive pass one steep filter that is flat where torques are balanced; the balance, all of
its columns and its target, passes a second one. So no side of it is filtered more than the other,
and a law sees a motion sharper than the balance.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import DT, LOAD, TIME, V
from frictionjoint.identify.commanded import Commanded
from frictionjoint.identify.noise import Noise
from frictionjoint.identify.reversals import Path, path_of
from frictionjoint.measured.derivatives import HIGHEST
from frictionjoint.measured.lowpass import LowPass, Spectrum, gentle, steep

# samples in a period of the balance's corner, in a fit and in a coarse search: with less than four
# what the filter passes is folded back
A_BALANCE, _A_COARSE = 4.0, 32.0
# what a log holds of the motor, the one to be preferred first
Drive = Literal["torque", "voltage", "current"]


@dataclass(frozen=True)
class Band:
    """Corners of the two filters, Hz: of the balance, and of the motion that makes it.

    zero_order_hold: whether a measured drive holds its torque from one sample to the next.
    """

    balance: float
    motion: float
    zero_order_hold: bool = False


@dataclass(frozen=True)
class Segment:
    """One log, prepared.

    Attributes:
        name: of the log.
        dt: s between samples of the grid.
        bandwidth_hz: corner of the filter that the balance passes.
        step: one in `step` samples of the balance is kept for the fit.
        signals: shape (n, N_SIGNALS) on the grid; H and DTAU are filled by a fit.
        drive: torque, voltage or current behind the filter of the motion, shape (n,).
        driven: shape (n,), False where the joint was let go: the motor's leads are open, so that
            neither a voltage nor the back-EMF acts.
        mask: shape (n,), False where the torque is not known or a filter edge spoils the sample.
        others: further measured quantities by name, for dependences that no effect explains.
        noise: of the instruments. sample: s between the samples of the log itself.
        corner_hz: of the filter of the motion.
        commanded: where the drive is not measured, what its controller made it of.
        weight: of each sample in a fit, shape (n,), see `weights`; None: all alike.
        held: friction at the first sample over Fc, see `start`.
        swing: deflection of an elastic joint at the first sample and its rate, see `start`.
        driven_along: what a law is driven along, where it was made before; see `path`.
        unknown: friction outside of the joint that the motion does not determine, N m, (n,).
    """

    name: str
    dt: float
    bandwidth_hz: float
    step: int
    signals: Array
    drive: Array
    driven: NDArray[np.bool_]
    mask: NDArray[np.bool_]
    others: dict[str, Array]
    noise: Noise
    sample: float
    corner_hz: float
    commanded: Commanded | None = None
    weight: Array | None = None
    held: float = 0.0
    swing: tuple[float, float] = (0.0, 0.0)
    driven_along: Path | None = None
    unknown: Array | None = None

    @cached_property
    def path(self) -> Path:
        """Time and position that a law is driven along."""
        return self.driven_along or path_of(self.signals, self.noise.resolution)

    @cached_property
    def _drive_spectrum(self) -> tuple[Spectrum, Array]:
        return self._filter.spectrum(self.drive)

    def balanced_drive(self, delay: float = 0.0, derivative: int = 0) -> Array:
        """The drive as it was `delay` seconds before each sample, behind the balance's filter."""
        return self._filter.back(self._drive_spectrum, derivative, delay)

    def drive_before(self, delay: float) -> Array:
        """The drive as it was `delay` seconds before each sample, shape (n,)."""
        if delay == 0.0:
            return self.drive
        time = self.signals[:, TIME]
        earlier = np.clip(time - delay, time[0], time[-1])
        return np.asarray(CubicSpline(time, self.drive)(earlier))

    @cached_property
    def balanced_load(self) -> Array:
        """Torque of the rigid body on the kept samples, N m."""
        return self.lowpass(self.signals[:, LOAD])[self.kept]

    @cached_property
    def balanced_velocity(self) -> Array:
        """Velocity on the kept samples, rad/s."""
        return self.lowpass(self.signals[:, V])[self.kept]

    def lowpass(self, x: Array) -> Array:
        """What the balance has of a signal: filtered along axis 0 and decimated."""
        return self._filter(x)

    def smooth(self, x: Array) -> Array:
        """A signal behind the balance's filter, all samples of it."""
        return _lowpass(len(self.drive), self.dt, self.bandwidth_hz, 1)(x)

    @property
    def kept_weight(self) -> Array:
        """Weights of the kept samples."""
        if self.weight is None:
            return np.ones(int(self.kept.sum()))
        return self.weight[:: self.step][self.kept]

    @property
    def _filter(self) -> LowPass:
        return _lowpass(len(self.drive), self.dt, self.bandwidth_hz, self.step)

    @property
    def kept(self) -> NDArray[np.bool_]:
        """The mask on the decimated grid."""
        return self.mask[:: self.step]


@dataclass(frozen=True)
class Prepared:
    """All logs of a fit.

    Attributes:
        segments: one a log.
        joint: name; slide: True for a slide joint.
        drive: what the logs hold of the motor. The torque that a voltage or a current makes is
            known only up to a gain.
        band: of the filters.
        let_go: some samples are of a voltage-driven joint that was let go: there viscous friction
            acts without back-EMF, so that the two can be distinguished.
    """

    segments: tuple[Segment, ...]
    joint: str
    slide: bool
    drive: Drive
    band: Band
    let_go: bool = False

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def samples(self) -> int:
        """Kept samples of all logs."""
        return sum(int(s.kept.sum()) for s in self.segments)

    @property
    def gain_unknown(self) -> bool:
        """Whether the drive is a torque up to a gain, which the load then determines."""
        return self.drive != "torque"

    @property
    def voltage_driven(self) -> bool:
        """Whether a back-EMF works against the drive."""
        return self.drive == "voltage"

    @property
    def commanded(self) -> bool:
        """Whether the drive is what a controller made of its commands, and not measured."""
        return all(s.commanded is not None for s in self.segments)

    def thinned(self, most: int) -> "Prepared":
        """The logs for a coarse search, in a narrower band where there are more samples than
        about `most`; finer motion is lost.
        """
        factor = max(1.0, self.samples / most)
        return replace(self, segments=tuple(_thinned(s, factor) for s in self.segments))

    def subset(self, indices: list[int]) -> "Prepared":
        """Some of the logs."""
        return replace(self, segments=tuple(self.segments[i] for i in indices))


@lru_cache(maxsize=256)
def _lowpass(n: int, dt: float, corner_hz: float, step: int) -> LowPass:
    """A search filters with the same few many thousand times."""
    return LowPass(n, dt, corner_hz, gentle, step)


def _thinned(s: Segment, factor: float) -> Segment:
    """A log in a band narrower by a factor, on a grid to match."""
    bandwidth_hz = s.bandwidth_hz / factor
    step = max(1, int(1.0 / (s.dt * _A_COARSE * bandwidth_hz)))
    smooth = LowPass(len(s.drive), s.dt, min(4.0 * bandwidth_hz, HIGHEST / s.dt), steep, step)
    signals = s.signals[::step].copy()
    signals[1:, DT] = dt = s.dt * step
    return replace(
        s,
        dt=dt,
        bandwidth_hz=bandwidth_hz,
        step=max(1, int(1.0 / (dt * A_BALANCE * bandwidth_hz))),
        signals=signals,
        driven_along=None,
        drive=smooth(s.drive),
        commanded=None if s.commanded is None else s.commanded.thinned(smooth),
        driven=s.driven[::step],
        mask=s.mask[::step],
        weight=None if s.weight is None else s.weight[::step],
        unknown=None if s.unknown is None else s.unknown[::step],
        others={name: x[::step] for name, x in s.others.items()},
    )
