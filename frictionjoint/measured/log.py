"""One measured log of one joint."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError


@dataclass(frozen=True, kw_only=True)
class JointLog:
    """A joint's motion and drive, one row a sample, all arrays of shape (n,).

    Attributes:
        name: of the log, as the report shows it. joint: of the joint.
        time: s, increasing. position: rad (m for a slide).
        velocity: rad/s, or None. torque: N m (N), or None. voltage: V at the motor, or None.
        current: of the motor, or None: a torque up to an unknown gain, in whatever unit.
        temperature: deg C, or None. target: commanded position, or None.
        motor_position: second encoder, rad at the motor, or None.
        torque_enabled: False where the drive is off, or None where it is always on.
        slide: True for a slide joint.
        other_positions: positions of other joints by name, rad (m).
        other_velocities: measured velocities of other joints by name, rad/s (m/s).
        metadata: figures that came with the log (gains, masses), by name.
    """

    name: str
    joint: str
    time: Array
    position: Array
    velocity: Array | None = None
    torque: Array | None = None
    voltage: Array | None = None
    current: Array | None = None
    temperature: Array | None = None
    target: Array | None = None
    motor_position: Array | None = None
    torque_enabled: NDArray[np.bool_] | None = None
    slide: bool = False
    other_positions: dict[str, Array] = field(default_factory=dict)
    other_velocities: dict[str, Array] = field(default_factory=dict)
    metadata: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.name or not self.joint:
            raise LogError("a log needs a name and the name of its joint")
        n = np.shape(self.time)
        for name, x in self.arrays().items():
            if x.ndim != 1 or x.shape != n:
                raise LogError(f"{self.name}: {name} has shape {x.shape}, time {n}: make them one")
            if not np.isfinite(x).all():
                i = int(np.argmin(np.isfinite(x)))
                raise LogError(f"{self.name}, sample {i}, {name}: {x[i]}, give a number")
        if n[0] < 2 or np.diff(self.time).min() <= 0.0:
            raise LogError(f"{self.name}: time must increase over two samples or more")
        if all(x is None for x in (self.torque, self.voltage, self.current)):
            raise LogError(f"{self.name}: no torque, voltage or current, add one of them")

    def columns(self) -> dict[str, Array]:
        """This joint's arrays that are there, by field name."""
        drives = ("torque", "voltage", "current")
        more = ("temperature", "target", "motor_position", "torque_enabled")
        names = ("time", "position", "velocity", *drives, *more)
        found = {name: getattr(self, name) for name in names}
        return {name: x for name, x in found.items() if x is not None}

    def arrays(self) -> dict[str, Array]:
        """All arrays, the other joints' among them."""
        positions = {f"position of {name}": x for name, x in self.other_positions.items()}
        velocities = {f"velocity of {name}": x for name, x in self.other_velocities.items()}
        return self.columns() | positions | velocities

    def part(self, samples: slice, suffix: str) -> "JointLog":
        """A stretch of the log under a new name."""
        own: dict[str, Any] = {name: x[samples] for name, x in self.columns().items()}
        return replace(
            self,
            name=f"{self.name}{suffix}",
            other_positions={name: x[samples] for name, x in self.other_positions.items()},
            other_velocities={name: x[samples] for name, x in self.other_velocities.items()},
            **own,
        )

    @property
    def duration(self) -> float:
        """s from the first sample to the last."""
        return float(self.time[-1] - self.time[0])


def split_in_time(log: JointLog, fraction: float) -> tuple[JointLog, JointLog]:
    """The first part of a log, and its last `fraction` to hold out.

    Raises:
        LogError: the fraction is not inside (0, 1), or leaves a part too short.
    """
    if not 0.0 < fraction < 1.0:
        raise LogError(f"held-out fraction is {fraction:g}: it must lie between 0 and 1")
    cut = round(len(log.time) * (1.0 - fraction))
    if min(cut, len(log.time) - cut) < 50:
        raise LogError(f"{log.name}: holding out {fraction:g} leaves a part under 50 samples")
    return log.part(slice(0, cut), " (first part)"), log.part(slice(cut, None), " (last part)")
