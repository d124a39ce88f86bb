"""From a log to the arrays a fit works on: smooth motion, rigid-body torque, signals.

Both sides of the torque balance pass the same zero-phase low-pass filter and the same
decimation, so that what the filter removes is missing on both sides.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import (
    DT,
    GEAR,
    GX,
    GY,
    JERK,
    LOAD,
    N_SIGNALS,
    SNAP,
    TEMP,
    TIME,
    A,
    Q,
    V,
)
from frictionjoint.errors import LogError
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.derivatives import (
    as_differenced,
    differentiate,
    uniform,
    uniform_motion,
    zero_phase,
)
from frictionjoint.measured.log import JointLog

# s, about what a simulation steps with; a slow log is not refined at any cost
_LAW_STEP, _MOST_REFINED = 1e-3, 8
# the motion and what follows from it
_SMOOTH = [Q, V, A, JERK, SNAP, LOAD, GEAR, GX, GY]
# what a log holds of the motor, the one to be preferred first
Drive = Literal["torque", "voltage", "current"]


@dataclass(frozen=True)
class Segment:
    """One log, prepared.

    Attributes:
        name: of the log.
        dt: s between samples of the uniform grid.
        bandwidth_hz: of the filter on both sides of the balance.
        step: one in `step` filtered samples is kept for the fit.
        signals: shape (n, N_SIGNALS) on the uniform grid; H and DTAU are filled by a fit.
        drive: measured torque, voltage or current, shape (n,), unfiltered.
        driven: shape (n,), False where the joint was let go: the motor's leads are open, so that
            neither a voltage nor the back-EMF acts.
        mask: shape (n,), False where the torque is not known or a filter edge spoils the sample.
        others: further measured quantities by name, for dependences that no effect explains.
        refine: steps of the law from one sample to the next, see `path`.
        averages: whether the derivatives were taken on this grid, see `lowpass`.
        held: friction at the first sample over Fc, see `start`.
        swing: deflection of an elastic joint at the first sample and its rate, see `start`.
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
    refine: int = 1
    averages: bool = False
    held: float = 0.0
    swing: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def path(self) -> tuple[Array, Array]:
        """Time and position that the law is driven along, `refine` steps a sample.

        A law's level belongs to the velocity at an instant; over an interval of a slow log that
        changes too much for its mean to stand in for it.
        """
        time, q = (np.ascontiguousarray(self.signals[:, k]) for k in (TIME, Q))
        if self.refine == 1:
            return time, q
        fine = np.linspace(time[0], time[-1], (len(time) - 1) * self.refine + 1)
        return fine, np.ascontiguousarray(CubicSpline(time, q)(fine))

    def drive_before(self, delay: float) -> Array:
        """The drive as it was `delay` seconds before each sample, shape (n,)."""
        if delay == 0.0:
            return self.drive
        time = self.signals[:, TIME]
        earlier = np.clip(time - delay, time[0], time[-1])
        return np.asarray(CubicSpline(time, self.drive)(earlier))

    def lowpass(self, x: Array, differenced: bool = False) -> Array:
        """Filter along axis 0 and decimate.

        Args:
            differenced: x is made of derivatives, which are averages over neighbouring samples
                already; all else is averaged alike, see `derivatives`.
        """
        if self.averages and not differenced:
            x = as_differenced(x)
        return zero_phase(x, self.dt, self.bandwidth_hz)[:: self.step]

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
        rest_speed: rad/s; slower samples are masked, see `rest`.
        let_go: some samples are of a voltage-driven joint that was let go: there viscous friction
            acts without back-EMF, so that the two can be told apart.
    """

    segments: tuple[Segment, ...]
    joint: str
    slide: bool
    drive: Drive
    rest_speed: float = 0.0
    let_go: bool = False

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def samples(self) -> int:
        """Kept samples of all logs."""
        return sum(int(s.kept.sum()) for s in self.segments)

    @property
    def gain_unknown(self) -> bool:
        """Whether the drive is a torque up to a gain, which the load then tells."""
        return self.drive != "torque"

    @property
    def voltage_driven(self) -> bool:
        """Whether a back-EMF works against the drive."""
        return self.drive == "voltage"

    def thinned(self, most: int) -> "Prepared":
        """The logs for a coarse search: at the rate a fit keeps, and in a narrower band where that
        is more than about `most` samples in all; finer motion is lost.
        """
        factor = max(1, round(self.samples / most))
        return replace(self, segments=tuple(_thinned(s, factor) for s in self.segments))

    def subset(self, indices: list[int]) -> "Prepared":
        """Some of the logs."""
        return replace(self, segments=tuple(self.segments[i] for i in indices))


def _thinned(s: Segment, factor: int) -> Segment:
    step = s.step * factor
    dt, bandwidth_hz = s.dt * step, s.bandwidth_hz / factor
    # half an octave of grace, so that the fit's own filter still decides
    grace_hz = 1.5 * bandwidth_hz
    averages = step == 1
    signals = s.signals.copy()
    if factor > 1:
        signals[:, _SMOOTH] = zero_phase(s.signals[:, _SMOOTH], s.dt, grace_hz)
    signals = signals[::step]
    signals[1:, DT] = dt
    return replace(
        s,
        dt=dt,
        bandwidth_hz=bandwidth_hz,
        step=1,
        signals=signals,
        drive=zero_phase(s.drive if averages else as_differenced(s.drive), s.dt, grace_hz)[::step],
        driven=s.driven[::step],
        mask=s.mask[::step],
        others={name: x[::step] for name, x in s.others.items()},
        refine=1,
        averages=averages,
    )


def prepare(logs: list[JointLog], body: RigidBody, bandwidth_hz: float | None = None) -> Prepared:
    """Prepare logs of one joint; the median of the logs' bandwidths serves all.

    Raises:
        LogError: not the same drive in all logs.
    """
    drives = [_drive(log)[0] for log in logs]
    for log, drive in zip(logs, drives, strict=True):
        if drive != drives[0]:
            what = f"{logs[0].name} has a {drives[0]} and {log.name} a {drive}"
            raise LogError(f"{what}: give logs of one kind")
    if bandwidth_hz is None:
        bandwidth_hz = float(np.median([differentiate(log).bandwidth_hz for log in logs]))
    segments = tuple(_segment(log, body, bandwidth_hz) for log in logs)
    free = any(bool(np.any(s.mask & ~s.driven)) for s in segments)
    let_go = free and drives[0] == "voltage"
    return Prepared(segments, body.joint, bool(body.slide), drives[0], let_go=let_go)


def _drive(log: JointLog) -> tuple[Drive, Array]:
    """What a log holds of the motor; `JointLog` sees to it that there is something."""
    for name in get_args(Drive):
        values = getattr(log, name)
        if values is not None:
            return name, values
    raise LogError(f"{log.name}: no torque, voltage or current, add one of them")


def _segment(log: JointLog, body: RigidBody, bandwidth_hz: float) -> Segment:
    motion = differentiate(log, bandwidth_hz)
    t = motion.time
    n, dt = len(t), float(t[1] - t[0])
    kind, drive = _drive(log)
    others = {}
    for name, position in log.other_positions.items():
        q = zero_phase(uniform_motion(log.time, position, t), dt, bandwidth_hz)
        v = np.gradient(q, dt)
        others[name] = (q, v, np.gradient(v, dt))
    named = {name: track for name, track in others.items() if name in body.joint_names}
    rigid = body.torque(motion.position, motion.velocity, motion.acceleration, named)
    signals = np.zeros((n, N_SIGNALS))
    signals[:, TIME] = t - t[0]
    signals[:, Q] = motion.position
    signals[:, V] = motion.velocity
    signals[:, A] = motion.acceleration
    signals[:, JERK] = np.gradient(motion.acceleration, dt)
    signals[:, SNAP] = np.gradient(signals[:, JERK], dt)
    signals[:, LOAD] = rigid.load
    signals[:, GEAR] = rigid.load - body.armature * motion.acceleration
    signals[:, GX] = rigid.gx
    signals[:, GY] = rigid.gy
    signals[:, DT] = dt
    signals[0, DT] = 0.0
    if log.temperature is not None:
        signals[:, TEMP] = uniform(log.time, log.temperature, t)
    mask = np.ones(n, dtype=bool)
    # a zero-phase filter is not to be trusted within about one period of its corner of the ends
    edge = min(n // 10, max(2, int(1.0 / (bandwidth_hz * dt))))
    mask[:edge] = mask[n - edge :] = False
    driven = np.ones(n, dtype=bool)
    if log.torque_enabled is not None:
        enabled = uniform(log.time, log.torque_enabled.astype(float), t)
        driven = enabled > 0.999
        # a motor without voltage gives no torque; of any other drive that is off nothing is known
        mask &= _away_from_switching(enabled, edge) if kind == "voltage" else driven
    measured = uniform(log.time, drive, t)
    if kind == "voltage":
        measured = np.where(driven, measured, 0.0)
    return Segment(
        name=log.name,
        dt=dt,
        bandwidth_hz=bandwidth_hz,
        step=max(1, int(1.0 / (dt * 4.0 * bandwidth_hz))),
        signals=signals,
        drive=measured,
        driven=driven,
        mask=mask,
        others={
            f"{name}.{kind}": track[i]
            for name, track in others.items()
            for i, kind in enumerate(("position", "velocity", "acceleration"))
        }
        | {name: uniform(log.time, x, t) for name, x in log.signals.items()},
        refine=int(np.clip(round(dt / _LAW_STEP), 1, _MOST_REFINED)),
        averages=True,
    )


def _away_from_switching(enabled: Array, edge: int) -> NDArray[np.bool_]:
    """False within `edge` samples of a drive that goes on or off: a filter smears the moment."""
    away = np.ones(len(enabled), dtype=bool)
    for k in np.flatnonzero(np.diff(enabled)):
        away[max(0, k - edge + 1) : k + edge + 1] = False
    return away
