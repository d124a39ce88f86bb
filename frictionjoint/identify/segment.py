"""A log prepared for a fit: smooth motion, rigid-body torque, signals, on one grid.

Motion and drive pass a steep filter that is flat in the torque band. All columns and the target of
the balance pass a second filter. So both sides of the balance are filtered equally, and the law is
evaluated along a motion with a wider band than the balance.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.signals import DT, GEAR, LOAD, Q, V
from frictionjoint.errors import few
from frictionjoint.identify.bundle import Bundle, Cache, Commanded
from frictionjoint.identify.noise import Band, Noise, clear_of, corner_above_noise
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.tracks import Path, Start, path_of
from frictionjoint.measured.derivatives import HIGHEST
from frictionjoint.measured.lowpass import LowPass, LowPasses, Spectrum, gentle, places, steep

# samples in a period of the balance's corner: with less, what the filter passes is folded back
A_BALANCE = 4.0
# bound of the Coulomb level, in units of the drive: a law needs one above zero
LEAST_LEVEL = 1e-12
# what a log holds of the motor, the one to be preferred first
Drive = Literal["torque", "voltage", "current"]


@dataclass(frozen=True)
class Segment:
    """One prepared log, its arrays of shape (n,) on a uniform grid."""

    name: str
    dt: float  # s between samples of the grid
    bandwidth_hz: float  # corner of the filter of the balance
    step: int  # one in `step` samples is kept for the fit
    signals: Array  # shape (n, N_SIGNALS); H and DTAU are filled by a fit
    drive: Array  # torque, voltage or current after the filter of the motion
    # False while the motor is off: its leads are open, so neither a voltage nor the back-EMF acts
    driven: NDArray[np.bool_]
    mask: NDArray[np.bool_]  # False where the torque is unknown or a filter edge spoils the sample
    others: dict[str, Array]  # further measured quantities by name, for unexplained dependences
    noise: Noise
    sample: float  # sampling interval of the log itself, s
    corner_hz: float  # corner of the filter of the motion
    commanded: Commanded | None = None  # for an unmeasured drive, the commands of its controller
    weight: Array | None = None  # of each sample in a fit, see `weights`; None: all equal
    held: float = 0.0  # friction at the first sample over Fc, see `start`
    swing: tuple[float, float] = (0.0, 0.0)  # first deflection of an elastic joint, and its rate
    driven_along: Path | None = None  # cached path of a law, see `path`
    unknown: Array | None = None  # friction outside of the joint that no motion determines, N m
    # 1 while a measured drive is at its largest value, -1 at its smallest; None: it is at neither
    saturated: Array | None = None
    inertia: float = 0.0  # mean inertia about the joint's axis, kg m^2 (kg)
    # start and end, s in the log's time, of masked parts in which another drive turns the joint
    turned_by_another: tuple[tuple[float, float], ...] = ()

    @cached_property
    def path(self) -> Path:
        """Time and position along which a law is driven."""
        return self.driven_along or path_of(self.signals, self.noise.resolution)

    @cached_property
    def start(self) -> Start:
        """Initial state of the log."""
        position = self.signals[:, Q]
        return Start(self.held, float(position[0]), float(np.ptp(position)))

    @cached_property
    def _drive_spectrum(self) -> Spectrum:
        return self.filter.spectrum(self.drive)

    def balanced(self, x: Array) -> Array:
        """A signal, along axis 0, after the filter of the balance, on the kept samples."""
        return self.filter(x)[self.kept]

    def balanced_drive(self, delay: float = 0.0, derivative: int = 0) -> Array:
        """`balanced` of the drive `delay` seconds before each sample."""
        return self.filter.back(self._drive_spectrum, derivative, delay)[self.kept]

    @cached_property
    def balanced_load(self) -> Array:
        """Rigid-body torque on the kept samples, N m."""
        return self.balanced(self.signals[:, LOAD])

    @cached_property
    def gear(self) -> Array:
        """Torque that the gear transmits, N m, shape (n,), in the band where it exceeds its noise.

        Effects use its magnitude. Noise of the accelerations would bias that upwards; in a narrower
        band it would miss what the torque does within a quick stop.
        """
        torque = self.signals[:, GEAR]
        corner = corner_above_noise(torque, self.dt, self.bandwidth_hz, self.corner_hz)
        return _lowpass(len(torque), self.dt, corner, 1)(torque)

    @property
    def undecimated(self) -> LowPass:
        """The filter of the balance, without decimation."""
        return _lowpass(len(self.drive), self.dt, self.bandwidth_hz, 1)

    def at_kept(self, x: Array) -> Array:
        """A quantity at the kept samples, not filtered."""
        return np.asarray(x[:: self.step][self.kept])

    @property
    def filter(self) -> LowPass:
        """The filter of the balance."""
        return _lowpass(len(self.drive), self.dt, self.bandwidth_hz, self.step)

    @property
    def kept(self) -> NDArray[np.bool_]:
        """The mask on the decimated grid."""
        return self.mask[:: self.step]

    def each(self, change: Callable[[Array], Array]) -> Self:
        """The log with a change of every array along its samples."""
        names = ("signals", "drive", "driven", "mask", "weight", "unknown", "saturated")
        arrays = {n: x for n in names if (x := getattr(self, n)) is not None}
        changed: dict[str, Any] = {n: change(x) for n, x in arrays.items()}
        others = {name: change(x) for name, x in self.others.items()}
        return replace(self, **changed, others=others, driven_along=None)

    def without_limits(self) -> Self:
        """The log without samples at the end of its drive's range, see `Band`."""
        if self.saturated is None:
            return self
        clear = clear_of(self.saturated != 0.0, self.bandwidth_hz, self.dt)
        return replace(self, mask=self.mask & clear)


@dataclass(frozen=True, eq=False)
class Prepared:
    """All logs of a fit."""

    segments: tuple[Segment, ...]
    joint: str
    slide: bool
    drive: Drive  # the torque per voltage or current is an unknown gain
    band: Band
    # whether a voltage-driven joint has its motor off in some samples: there viscous friction acts
    # without back-EMF, so that the two can be distinguished
    motor_off: bool = False
    # names of time offsets that are assumed to be zero: see `starts.with_times`, or because an
    # inertia error was found in these logs
    nothing: frozenset[str] = frozenset()
    slow: bool = False  # whether the speeds hardly exceed the Stribeck velocity, see `base_fit`
    # bound of Fc, in units of the drive, that `assumptions.with_assumed_level` raises
    least_level: float = LEAST_LEVEL

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def names(self) -> str:
        """Names of the logs, for a message."""
        return few([s.name for s in self.segments])

    @cached_property
    def log_index(self) -> Index:
        """Log of each kept sample of all logs in order, shape (n,)."""
        counts = [int(s.kept.sum()) for s in self.segments]
        return np.repeat(np.arange(len(counts)), counts)

    def by_log(self, x: Array) -> list[Array]:
        """Values on the kept samples of all logs in order, split by log."""
        return np.split(x, np.searchsorted(self.log_index, np.arange(1, len(self))))

    @property
    def gain_unknown(self) -> bool:
        """Whether the drive is a torque of unknown gain, which the load then determines."""
        return self.drive != "torque"

    @property
    def voltage_driven(self) -> bool:
        """Whether a back-EMF opposes the drive."""
        return self.drive == "voltage"

    @property
    def commanded(self) -> bool:
        """Whether the drive is computed by a controller from commands, and not measured."""
        return all(s.commanded is not None for s in self.segments)

    @property
    def damped(self) -> bool:
        """Whether a controller with damping computed the drive."""
        return any(s.commanded is not None and s.commanded.damped for s in self.segments)

    def at_kept(self, column: int) -> Array:
        """One of the signals at the kept samples of all logs in order, shape (n,)."""
        return np.concatenate([s.at_kept(s.signals[:, column]) for s in self.segments])

    @cached_property
    def span(self) -> float:
        """Longest travel of a log, rad (m)."""
        return max(s.start.travel for s in self.segments)

    @cached_property
    def usual_travel(self) -> float:
        """Travel of all logs without the outermost 10% of the samples, rad (m)."""
        return float(np.subtract(*np.quantile(self.at_kept(Q), (0.95, 0.05)))) or self.span

    @cached_property
    def top_speed(self) -> float:
        """Top speed of all logs without the fastest 1% of samples, rad/s (m/s); 1 if none move."""
        speeds = np.concatenate([np.abs(s.signals[:, V]) for s in self.segments])
        return float(np.quantile(speeds, 0.99)) or 1.0

    @cached_property
    def weight(self) -> Array:
        """Weights of the kept samples of all logs in order."""
        ones = (np.ones(len(s.drive)) if s.weight is None else s.weight for s in self.segments)
        return np.concatenate([s.at_kept(x) for s, x in zip(self.segments, ones, strict=True)])

    @property
    def bounding_speed(self) -> float:
        """Speed that bounds the Stribeck velocity to 0.3 of it, rad/s (m/s).

        In slow logs the bound is the top speed; in others so wide a curve imitates a delay, which
        turns inertia into negative viscosity.
        """
        return self.top_speed / 0.3 if self.slow else self.top_speed

    @property
    def balanced_drive(self) -> Array:
        """Drive on the kept samples of all logs in order."""
        return self.whole.balanced(self.whole.driven)

    @property
    def balanced_load(self) -> Array:
        """Rigid-body torque on the kept samples of all logs in order, N m."""
        return self.whole.load_and_velocity[:, 0]

    @property
    def whole(self) -> Bundle:
        """All logs in one part."""
        return self.bundles(1)[0]

    def bundles(self, parts: int) -> tuple[Bundle, ...]:
        """The logs in at most a given number of parts, with about equal numbers of samples."""
        parts = min(parts, len(self.segments))
        if parts not in self._bundles:
            lengths = np.array([len(s.drive) for s in self.segments])
            middle = np.cumsum(lengths) - 0.5 * lengths
            part = (middle * (parts / lengths.sum())).astype(int)
            logs = [[self.segments[i] for i in np.flatnonzero(part == k)] for k in range(parts)]
            self._bundles[parts] = tuple(Bundle(some) for some in logs if some)
        return self._bundles[parts]

    def tracks(self, law: Shape) -> list[Array]:
        """H and dz/dq of a law along each log, shape (2, n)."""
        found = self.whole.tracks.along(law)
        return [found[:, own] for own in self.whole.places]

    def smooth(self, x: Sequence[Array]) -> list[Array]:
        """A signal of each log after the filter of the balance, at all samples."""
        whole = LowPasses([s.undecimated for s in self.segments])(np.concatenate(x)[None])[0]
        return [whole[own] for own in places([len(one) for one in x])]

    @cached_property
    def _bundles(self) -> dict[int, tuple[Bundle, ...]]:
        return {}

    @cached_property
    def _thinned(self) -> dict[int, "Prepared"]:
        return {}

    @cached_property
    def columns(self) -> Cache:
        """Cache of arrays that change neither with a law nor with weights or initial states."""
        return Cache(max(12_000_000, 300 * self.log_index.nbytes))

    def begun(self, segments: Sequence[Segment]) -> "Prepared":
        """The logs with other initial states."""
        found = replace(self, segments=tuple(segments))
        vars(found)["columns"] = self.columns
        return found

    def weighed(self, weights: Sequence[Array]) -> "Prepared":
        """The logs with other weights of their samples, shape (n,) each.

        Cached results stay valid: no column of a balance depends on a weight.
        """
        logs = zip(self.segments, weights, strict=True)
        found = self.begun([replace(s, weight=w) for s, w in logs])
        vars(found).update(_bundles=self._bundles, _thinned=self._thinned)
        return found

    def thinned(self, most: int) -> "Prepared":
        """The logs for a coarse search, in a narrower band beyond about `most` samples."""
        if most not in self._thinned:
            factor = max(1.0, len(self.log_index) / most)
            segments = tuple(_thinned(s, factor) for s in self.segments)
            self._thinned[most] = replace(self, segments=segments)
        found = self._thinned[most]
        pairs = zip(self.segments, found.segments, strict=True)
        weights = [s.weight[:: round(t.dt / s.dt)] for s, t in pairs if s.weight is not None]
        return found.weighed(weights) if weights else found

    def without_limits(self) -> "Prepared":
        """The logs without samples at the end of the drive's range: its sensor saturates."""
        return replace(
            self,
            segments=tuple(s.without_limits() for s in self.segments),
            band=replace(self.band, sensor_saturates=True),
        )

    def subset(self, indices: list[int]) -> "Prepared":
        """Some of the logs."""
        return replace(self, segments=tuple(self.segments[i] for i in indices))


@lru_cache(maxsize=256)
def _lowpass(n: int, dt: float, corner_hz: float, step: int) -> LowPass:
    """A cached filter: a search uses the same few many thousand times."""
    return LowPass(n, dt, corner_hz, gentle, step)


def _thinned(s: Segment, factor: float) -> Segment:
    """A log in a narrower band, on a coarser grid."""
    bandwidth_hz = s.bandwidth_hz / factor
    step = max(1, int(1.0 / (s.dt * 32.0 * bandwidth_hz)))
    smooth = LowPass(len(s.drive), s.dt, min(4.0 * bandwidth_hz, HIGHEST / s.dt), steep, step)
    signals = s.signals[::step].copy()
    signals[1:, DT] = dt = s.dt * step
    return replace(
        s.each(lambda x: x[::step]),
        dt=dt,
        bandwidth_hz=bandwidth_hz,
        step=max(1, int(1.0 / (dt * A_BALANCE * bandwidth_hz))),
        signals=signals,
        drive=smooth(s.drive),
        commanded=None if s.commanded is None else s.commanded.thinned(smooth),
    )
