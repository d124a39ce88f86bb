"""From a log to the arrays a fit works on: smooth motion, rigid-body torque, signals.

Motion and drive pass one steep filter that is flat where torques are balanced; the balance, all of
its columns and its target, passes a second one. So no side of it is filtered more than the other,
and a law sees a motion sharper than the balance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import commands, with_drive
from frictionjoint.effects.signals import (
    DT,
    GEAR,
    GX,
    GY,
    LOAD,
    N_SIGNALS,
    TEMP,
    TIME,
    A,
    Q,
    V,
)
from frictionjoint.errors import LogError
from frictionjoint.identify.commanded import Commanded
from frictionjoint.identify.noise import Noise, count_of, noise_of
from frictionjoint.identify.reversals import Path, path_of
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.derivatives import (
    HIGHEST,
    MOTION_ORDER,
    motion_band,
    on_a_grid,
    uniform,
    uniform_motion,
)
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, Spectrum

# s, the longest step of the grid on which laws are driven: a reversal between two samples of it is
# blurred. A slow log is not refined at any cost.
_STEP_S, _MOST_REFINED = 2.5e-3, 16
# the balance: least and largest corner in Hz. Friction and the effects of the catalogue act below
# the second; above it only time is spent.
_LEAST_HZ, _MOST_HZ = 5.0, 60.0
BALANCE_ORDER = 4
# samples of the log in a period of the balance's corner: a torque that a controller holds from one
# to the next is less by 0.6% there, and no log tells whether it is held
_A_SAMPLE = 16.0
# samples in a period of each corner. With 2.5 and 16 a loop takes a third less, but other laws are
# taken on measured logs, which err more on what is held out.
_A_MOTION, _A_BALANCE, _A_COARSE = 4.0, 4.0, 32.0
# what a log holds of the motor, the one to be preferred first
Drive = Literal["torque", "voltage", "current"]


@dataclass(frozen=True)
class Band:
    """Corners of the two filters, Hz: of the balance, and of the motion that makes it."""

    balance: float
    motion: float


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
    return LowPass(n, dt, corner_hz, BALANCE_ORDER, step)


def _thinned(s: Segment, factor: float) -> Segment:
    """A log in a band narrower by a factor, on a grid to match."""
    bandwidth_hz = s.bandwidth_hz / factor
    step = max(1, int(1.0 / (s.dt * _A_COARSE * bandwidth_hz)))
    steep = LowPass(len(s.drive), s.dt, min(4.0 * bandwidth_hz, HIGHEST / s.dt), MOTION_ORDER, step)
    signals = s.signals[::step].copy()
    signals[1:, DT] = dt = s.dt * step
    return replace(
        s,
        dt=dt,
        bandwidth_hz=bandwidth_hz,
        step=max(1, int(1.0 / (dt * _A_BALANCE * bandwidth_hz))),
        signals=signals,
        driven_along=None,
        drive=steep(s.drive),
        commanded=None if s.commanded is None else s.commanded.thinned(steep),
        driven=s.driven[::step],
        mask=s.mask[::step],
        weight=None if s.weight is None else s.weight[::step],
        unknown=None if s.unknown is None else s.unknown[::step],
        others={name: x[::step] for name, x in s.others.items()},
    )


def prepare(
    logs: list[JointLog],
    body: RigidBody | Sequence[RigidBody],
    band: Band | None = None,
    controller: Controller | None = None,
) -> Prepared:
    """Prepare logs of one joint.

    Args:
        body: of the joint; one a log where they are of different loads.
        controller: that drove it, for logs without torque, voltage or current.
        band: of logs that these are compared with; None: what the logs themselves allow.
    Raises:
        LogError: not the same drive in all logs, or one that nothing tells.
    """
    bodies = [body] * len(logs) if isinstance(body, RigidBody) else list(body)
    body = bodies[0]
    given = list(zip(logs, bodies, strict=True))
    logs = [with_drive(log, controller) for log in logs]
    drives = [_drive(log)[0] for log in logs]
    for log, drive in zip(logs, drives, strict=True):
        if drive != drives[0]:
            what = f"{logs[0].name} has a {drives[0]} and {log.name} a {drive}"
            raise LogError(f"{what}: give logs of one kind")
    if band is None:
        motions = [motion_band(*on_a_grid(log)[1:]) for log in logs]
        # a servo's logs are many and short, and a corrupt one must not widen the band of all
        over_logs = (
            np.max if all(a is b for a, (b, _) in zip(logs, given, strict=True)) else np.median
        )
        motion = max(float(over_logs([m.whole for m in motions])), 2.0 * _LEAST_HZ)
        main = float(over_logs([m.main for m in motions]))
        wide = Band(motion / 2.0, motion)
        first = [_segment(log, b, wide, controller) for log, b in given]
        band = Band(_balance_hz(first, main, motion), motion)
    segments = tuple(_segment(log, b, band, controller) for log, b in given)
    free = any(bool(np.any(s.mask & ~s.driven)) for s in segments)
    let_go = free and drives[0] == "voltage"
    return Prepared(segments, body.joint, bool(body.slide), drives[0], band, let_go=let_go)


def _balance_hz(segments: list[Segment], main: float, motion: float) -> float:
    """Corner of the balance: as wide as the noises allow, but wide enough for the motion."""
    most = min(_MOST_HZ, motion / 2.0)
    least = min(max(_LEAST_HZ, main), most)
    slowest = max(s.sample for s in segments)
    most = max(least, min(most, 1.0 / (_A_SAMPLE * slowest)))
    return float(np.median([s.noise.band_hz(least, most, BALANCE_ORDER) for s in segments]))


def _drive(log: JointLog) -> tuple[Drive, Array]:
    """What a log holds of the motor; `with_drive` sees to it that there is something."""
    for name in get_args(Drive):
        values = getattr(log, name)
        if values is not None:
            return name, values
    raise LogError(f"{log.name}: no torque, voltage or current, add one of them")


def _segment(log: JointLog, body: RigidBody, band: Band, controller: Controller | None) -> Segment:
    measured_log, log = log, with_drive(log, controller)
    grid, raw, sample = on_a_grid(log)
    finest = min(_STEP_S, 1.0 / (_A_MOTION * band.motion))
    step, up = max(1, int(finest / sample)), min(_MOST_REFINED, -int(-sample // _STEP_S))
    corner = min(band.motion, HIGHEST / sample)
    smooth = LowPass(len(grid), sample, corner, MOTION_ORDER, step, up)
    dt = sample * step / up
    n = -(-((len(grid) - 1) * up + 1) // step)
    t = grid[0] + dt * np.arange(n)

    def track(position: Array) -> tuple[Array, Array, Array]:
        spectrum = smooth.spectrum(position)
        return smooth.back(spectrum), smooth.back(spectrum, 1), smooth.back(spectrum, 2)

    q, v, a = track(raw)
    others = {
        name: track(uniform_motion(log.time, position, grid))
        for name, position in log.other_positions.items()
    }
    named = {name: triple for name, triple in others.items() if name in body.joint_names}
    rigid = body.torque(q, v, a, named)
    signals = np.zeros((n, N_SIGNALS))
    signals[:, TIME] = t - t[0]
    signals[:, Q], signals[:, V], signals[:, A] = q, v, a
    signals[:, LOAD] = rigid.load
    signals[:, GEAR] = rigid.load - body.armature * a
    signals[:, GX], signals[:, GY] = rigid.gx, rigid.gy
    signals[:, DT] = dt
    signals[0, DT] = 0.0
    # not a number where no thermometer was read
    signals[:, TEMP] = np.nan
    if log.temperature is not None:
        signals[:, TEMP] = uniform(log.time, log.temperature, t)
    mask = np.ones(n, dtype=bool)
    # a zero-phase filter is not to be trusted within about one period of its corner of the ends
    edge = min(n // 10, max(2, int(1.0 / (band.balance * dt))))
    mask[:edge] = mask[n - edge :] = False
    driven = np.ones(n, dtype=bool)
    kind, values = _drive(log)
    commanded = None
    if log is not measured_log and controller is not None:
        commanded = Commanded(commands(log, controller), grid, (smooth,))
        values = commanded.commands.mean_drive()
    measured = uniform(log.time, values, grid)
    if log.torque_enabled is not None:
        enabled = uniform(log.time, log.torque_enabled.astype(float), t)
        driven = enabled > 0.999
        # a motor without voltage gives no torque; of any other drive that is off nothing is known
        mask &= _away_from_switching(enabled, edge) if kind == "voltage" else driven
        if kind == "voltage":
            measured = np.where(uniform(t, driven.astype(float), grid) > 0.5, measured, 0.0)
    drive = smooth(measured)
    per_drive = 1.0 if kind == "torque" else _per_torque(drive, rigid.load, v)
    noise = noise_of(
        measured,
        raw,
        np.interp(grid, t, q),
        sample,
        count_of(log.position),
        inertia_of(signals) * per_drive,
    )
    return Segment(
        name=log.name,
        dt=dt,
        bandwidth_hz=band.balance,
        step=max(1, int(1.0 / (dt * _A_BALANCE * band.balance))),
        signals=signals,
        drive=drive,
        driven=driven,
        mask=mask,
        others={
            f"{name}.{kind}": triple[i]
            for name, triple in others.items()
            for i, kind in enumerate(("position", "velocity", "acceleration"))
        }
        | {name: uniform(log.time, x, t) for name, x in log.signals.items()},
        # a reconstructed drive leaps with its target, and has no noise
        noise=noise if commanded is None else replace(noise, torque=0.0),
        driven_along=path_of(signals, noise.resolution),
        unknown=rigid.unknown,
        sample=sample,
        corner_hz=band.motion,
        commanded=commanded,
    )


def inertia_of(signals: Array) -> float:
    """Torque of the rigid body over its acceleration, kg m^2; gravity goes with the position.

    Args:
        signals: of a log, shape (n, N_SIGNALS).
    """
    columns = np.column_stack([signals[:, [A, GX, GY]], np.ones(len(signals))])
    return abs(float(np.linalg.lstsq(columns, signals[:, LOAD], rcond=None)[0][0]))


def _per_torque(drive: Array, load: Array, velocity: Array) -> float:
    """Drive per unit of torque, roughly: of the load, with viscous and Coulomb friction."""
    columns = np.column_stack([load, velocity, np.sign(velocity), np.ones_like(load)])
    return abs(float(np.linalg.lstsq(columns, drive, rcond=None)[0][0]))


def _away_from_switching(enabled: Array, edge: int) -> NDArray[np.bool_]:
    """False within `edge` samples of a drive that goes on or off: a filter smears the moment."""
    away = np.ones(len(enabled), dtype=bool)
    for k in np.flatnonzero(np.diff(enabled)):
        away[max(0, k - edge + 1) : k + edge + 1] = False
    return away
