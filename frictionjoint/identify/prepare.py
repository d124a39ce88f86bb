"""From a log to the arrays a fit works on: smooth motion, rigid-body torque, signals.

Both sides of the torque balance pass the same zero-phase low-pass filter and the same
decimation, so that what the filter removes is missing on both sides.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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
from frictionjoint.measured.derivatives import differentiate, uniform, zero_phase
from frictionjoint.measured.log import JointLog


@dataclass(frozen=True)
class Segment:
    """One log, prepared.

    Attributes:
        name: of the log.
        dt: s between samples of the uniform grid.
        bandwidth_hz: of the filter on both sides of the balance.
        step: one in `step` filtered samples is kept for the fit.
        signals: shape (n, N_SIGNALS) on the uniform grid; H and DTAU are filled by a fit.
        drive: measured torque (or voltage, or current), shape (n,), unfiltered.
        driven: shape (n,), False where the joint was let go: the motor's leads are open, so that
            neither a voltage nor the back-EMF acts.
        mask: shape (n,), False where the torque is not known or a filter edge spoils the sample.
        others: further measured quantities by name, for dependences that no effect explains.
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

    def lowpass(self, x: Array) -> Array:
        """Filter along axis 0 and decimate."""
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
        voltage_driven: the drive is a voltage (or a current of unknown scale), so that the torque
            it makes is known only up to a gain.
        rest_speed: rad/s; slower samples are masked, see `rest`.
        let_go: some samples are of a voltage-driven joint that was let go: there viscous friction
            acts without back-EMF, so that the two can be told apart.
    """

    segments: tuple[Segment, ...]
    joint: str
    slide: bool
    voltage_driven: bool
    rest_speed: float = 0.0
    let_go: bool = False

    def __len__(self) -> int:
        return len(self.segments)

    def thinned(self) -> "Prepared":
        """The logs at the rate a fit keeps, for a coarse search; finer motion is lost."""
        return replace(self, segments=tuple(_thinned(s) for s in self.segments))

    def subset(self, indices: list[int]) -> "Prepared":
        """Some of the logs."""
        return replace(self, segments=tuple(self.segments[i] for i in indices))


def _thinned(s: Segment) -> Segment:
    dt = s.dt * s.step
    signals = s.signals[:: s.step].copy()
    signals[1:, DT] = dt
    # half an octave of grace, so that the fit's own filter still decides
    drive = zero_phase(s.drive, s.dt, 1.5 * s.bandwidth_hz)[:: s.step]
    others = {name: x[:: s.step] for name, x in s.others.items()}
    return replace(
        s,
        dt=dt,
        step=1,
        signals=signals,
        drive=drive,
        driven=s.driven[:: s.step],
        mask=s.mask[:: s.step],
        others=others,
    )


def prepare(logs: list[JointLog], body: RigidBody, bandwidth_hz: float | None = None) -> Prepared:
    """Prepare logs of one joint; the median of the logs' bandwidths serves all.

    Raises:
        LogError: neither torque nor voltage, or not the same in all logs.
    """
    voltage = [log.torque is None for log in logs]
    if any(voltage) and not all(voltage):
        a, b = logs[voltage.index(True)].name, logs[voltage.index(False)].name
        raise LogError(f"{a} has a voltage and {b} a torque: give logs of one kind")
    if bandwidth_hz is None:
        bandwidth_hz = float(np.median([differentiate(log).bandwidth_hz for log in logs]))
    segments = tuple(_segment(log, body, bandwidth_hz) for log in logs)
    let_go = voltage[0] and any(bool(np.any(s.mask & ~s.driven)) for s in segments)
    return Prepared(segments, body.joint, bool(body.slide), voltage[0], let_go=let_go)


def _segment(log: JointLog, body: RigidBody, bandwidth_hz: float) -> Segment:
    motion = differentiate(log, bandwidth_hz)
    t = motion.time
    n, dt = len(t), float(t[1] - t[0])
    drive = log.torque if log.torque is not None else log.voltage
    if drive is None:
        raise LogError(f"{log.name}: no torque and no voltage, add torque_nm or voltage_v")
    others = {}
    for name, position in log.other_positions.items():
        q = zero_phase(uniform(log.time, position, t), dt, bandwidth_hz)
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
        mask &= _away_from_switching(enabled, edge) if log.torque is None else driven
    measured = uniform(log.time, drive, t)
    if log.torque is None:
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
        },
    )


def _away_from_switching(enabled: Array, edge: int) -> NDArray[np.bool_]:
    """False within `edge` samples of a drive that goes on or off: a filter smears the moment."""
    away = np.ones(len(enabled), dtype=bool)
    for k in np.flatnonzero(np.diff(enabled)):
        away[max(0, k - edge + 1) : k + edge + 1] = False
    return away
