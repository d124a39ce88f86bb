"""One measured log of one joint."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arguments import expect

# Fewest samples of a log.
FEWEST_ROWS = 50
# In median sampling intervals: shorter gaps are interpolated, longer ones split the log.
LARGEST_GAP = 10.0
# A larger fraction leaves too little motion to fit.
MOST_HELD_OUT = 0.8
# quantities that a log may state its drive in
DRIVES = ("torque", "voltage", "current")
# fields of a log with arrays by name
_BY_NAME = ("other_positions", "other_velocities", "signals")


@dataclass(frozen=True, kw_only=True)
class JointLog:
    """Motion and drive of a joint, one row per sample, all arrays of shape (n,).

    Attributes:
        name: of the log, as shown in the report. joint: name of the joint.
        time: s, increasing. position: rad (m for a slide).
        velocity: rad/s, or None. torque: N m (N), or None. voltage: V at the motor, or None.
        current: of the motor in any unit, or None: a torque of unknown gain.
        temperature: deg C, or None. target: commanded position, or None.
        supply: supply voltage of a servo, V, or None.
        motor_position: second encoder, rad at the motor, or None.
        torque_enabled: False while the drive is off; None if it is always on.
        slide: True for a slide joint.
        other_positions: positions of other joints by name, rad (m).
        other_velocities: measured velocities of other joints by name, rad/s (m/s).
        signals: other measured quantities by name, in any unit, on which friction may depend (a
            normal load, a bus voltage).
        metadata: numbers in the log (gains, masses), by name.
        motion: name of the commanded motion.
        notes: repairs of the log that a reader of a result must know.
        before: the part of the log directly before the first sample, which determines the
            temperature and the friction state of the joint. None if there is none.
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
    supply: Array | None = None
    motor_position: Array | None = None
    torque_enabled: NDArray[np.bool_] | None = None
    slide: bool = False
    other_positions: dict[str, Array] = field(default_factory=dict)
    other_velocities: dict[str, Array] = field(default_factory=dict)
    signals: dict[str, Array] = field(default_factory=dict)
    metadata: dict[str, float] = field(default_factory=dict)
    motion: str = ""
    notes: tuple[str, ...] = ()
    before: "JointLog | None" = None

    def __post_init__(self) -> None:
        if not self.name or not self.joint:
            raise LogError("a log needs a name and the name of its joint")
        n = np.shape(self.time)
        for name, x in self.arrays().items():
            expect(x, np.ndarray, f"{self.name}: {name}", "give a numpy array, np.asarray(x)")
            if x.ndim != 1 or x.shape != n:
                shapes = f"{name} has shape {x.shape}, time {n}"
                raise LogError(f"{self.name}: {shapes}: make them equal")
            if not np.isfinite(x).all():
                i = int(np.argmin(np.isfinite(x)))
                raise LogError(f"{self.name}, sample {i}, {name}: {x[i]}, give a number")
        if n[0] < 2 or np.diff(self.time).min() <= 0.0:
            raise LogError(f"{self.name}: give two samples or more, with increasing time")
        drives = (self.torque, self.voltage, self.current, self.target)
        if all(x is None for x in drives):
            raise LogError(f"{self.name}: no torque, voltage, current or target, add one of them")
        # kernels read float64 without gaps; a slice of a table, or float32, may be neither
        for name, x in self.columns().items():
            kind = None if x.dtype == np.bool_ else np.float64
            object.__setattr__(self, name, np.ascontiguousarray(x, dtype=kind))
        for name in _BY_NAME:
            found = {
                key: np.ascontiguousarray(x, np.float64) for key, x in getattr(self, name).items()
            }
            object.__setattr__(self, name, found)

    def columns(self) -> dict[str, Array]:
        """The existing arrays of this joint, by field name."""
        more = ("temperature", "target", "supply", "motor_position", "torque_enabled")
        names = ("time", "position", "velocity", *DRIVES, *more)
        found = {name: getattr(self, name) for name in names}
        return {name: x for name, x in found.items() if x is not None}

    def arrays(self) -> dict[str, Array]:
        """All arrays, including other joints and signals."""
        positions = {f"position of {name}": x for name, x in self.other_positions.items()}
        velocities = {f"velocity of {name}": x for name, x in self.other_velocities.items()}
        return self.columns() | positions | velocities | self.signals

    def mapped(self, change: Callable[..., Array], *others: "JointLog") -> "JointLog":
        """The log without `before`, every array changed by a function of those of some logs."""

        def of(these: dict[str, Array], *those: dict[str, Array]) -> dict[str, Any]:
            return {name: change(x, *(x[name] for x in those)) for name, x in these.items()}

        more: dict[str, Any] = {
            name: of(getattr(self, name), *(getattr(x, name) for x in others)) for name in _BY_NAME
        }
        own: dict[str, Any] = of(self.columns(), *(x.columns() for x in others))
        return replace(self, before=None, **own, **more)

    def part(self, samples: slice, suffix: str) -> "JointLog":
        """A part of the log under a new name."""
        return replace(self.mapped(lambda x: x[samples]), name=f"{self.name}{suffix}")

    def with_before(self) -> "JointLog":
        """The log joined with its `before`."""
        if self.before is None:
            return self
        return self.mapped(lambda x, first: np.concatenate([first, x]), self.before)

    def with_gain(self, gain: float) -> "JointLog":
        """The log with the torque of a motor constant, N m per A or per V (N for a slide); of a
        voltage-driven motor, the identified viscous friction includes the back-EMF. LogError: the
        gain is not positive, or the log has neither current nor voltage."""
        if not (np.isfinite(gain) and gain > 0.0):
            raise LogError(f"gain is {gain:g}: give N m per A or per V, above 0")
        drive = self.current if self.current is not None else self.voltage
        if self.torque is not None or drive is None:
            raise LogError(f"{self.name}: the torque is measured, leave out the gain")
        return replace(self, torque=gain * drive, current=None, voltage=None)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, s."""
        return float(self.time[-1] - self.time[0])


def split_in_time(log: JointLog, fraction: float) -> tuple[JointLog, JointLog]:
    """The first part of a log, and its last `fraction` to hold out, with the first part as
    `before`; LogError if the fraction is not above 0 and at most `MOST_HELD_OUT`, or leaves a part
    too short."""
    if not 0.0 < fraction <= MOST_HELD_OUT:
        fix = f"give more than 0 and at most {MOST_HELD_OUT:g}"
        raise LogError(f"held-out fraction is {fraction:g}: {fix}")
    cut = round(len(log.time) * (1.0 - fraction))
    if min(cut, len(log.time) - cut) < FEWEST_ROWS:
        what = f"holding out {fraction:g} leaves a part under {FEWEST_ROWS} samples"
        raise LogError(f"{log.name}: {what}: record a longer log or hold out another part")
    gaps = np.flatnonzero(are_gaps(log.time[: cut + 1])) + 1
    since = int(gaps[-1]) if gaps.size else 0
    before = log.part(slice(since, cut), " (before)") if cut - since > 1 else None
    last = replace(log.part(slice(cut, None), " (last part)"), before=before)
    return log.part(slice(0, cut), " (first part)"), last


def are_gaps(time: Array) -> NDArray[np.bool_]:
    """Whether each step between samples at times of shape (n,) is a gap, shape (n - 1,)."""
    step = np.diff(time)
    return np.asarray(step > LARGEST_GAP * float(np.median(step)))


def split_at_gaps(log: JointLog) -> list[JointLog]:
    """The parts of a log between gaps, with a note on gaps; LogError if none is long enough."""
    at = np.flatnonzero(are_gaps(log.time)) + 1
    if not at.size:
        return [log]
    ends = [0, *(int(i) for i in at), len(log.time)]
    stretches = list(itertools.pairwise(ends))
    long = [(a, b) for a, b in stretches if b - a >= FEWEST_ROWS]
    where = f"{log.time[at[0]] - log.time[at[0] - 1]:.3g} s at {log.time[at[0]]:.6g} s"
    many = "" if at.size == 1 else f" and {at.size - 1} more"
    if not long:
        what = f"gaps ({where}{many}) leave no part of {FEWEST_ROWS} samples"
        raise LogError(f"{log.name}: {what}: record a log without gaps")
    left_out = sum(b - a for a, b in stretches) - sum(b - a for a, b in long)
    note = f"{log.name}: a gap of {where}{many}: split there."
    if left_out:
        note += f" {left_out} samples in stretches under {FEWEST_ROWS} are left out."
    return [
        replace(log.part(slice(a, b), f" ({i + 1} of {len(long)})"), notes=(*log.notes, note))
        for i, (a, b) in enumerate(long)
    ]
