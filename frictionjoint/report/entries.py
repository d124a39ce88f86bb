"""Results as the plain data of report.json, and entries of the report of one joint."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.measured.log import JointLog

Content = Mapping[str, Any]
Role = Literal["fit", "held-out"]
Interval = tuple[float, float]
Intervals = tuple[Interval, Interval]


def content_of(result: Any) -> Any:
    """A result as tables, lists, numbers and texts: as its `to_dict` decides, or by its fields."""
    if hasattr(result, "to_dict"):
        return content_of(result.to_dict())
    if is_dataclass(result):
        return {x.name: content_of(getattr(result, x.name)) for x in fields(result)}
    if isinstance(result, Mapping):
        return table_of(result)
    # JSON has no infinity
    if isinstance(result, float) and math.isinf(result):
        return None
    if isinstance(result, list | tuple):
        return [content_of(x) for x in result]
    return result


def table_of(results: Mapping[str, Any]) -> dict[str, Any]:
    """Results by name, as tables, lists, numbers and texts."""
    return {name: content_of(x) for name, x in results.items()}


@dataclass(frozen=True)
class LogEntry:
    """A log in the report."""

    name: str
    samples: int
    duration_s: float
    role: Role

    @classmethod
    def of(cls, log: JointLog, role: Role) -> Self:
        return cls(log.name, len(log.time), log.duration, role)


@dataclass(frozen=True)
class Evidence:
    """Why an effect was added, see ``diagnose.trace``; whether the logs leave its size open."""

    held_out_gain: float
    p_value: float
    selection_frequency: float
    runner_up: str | None
    margin: float
    ties: tuple[str, ...] = ()
    size_is_open: bool = False

    def to_dict(self) -> dict[str, Any]:
        optional = ("ties", "size_is_open")
        return {name: x for name, x in asdict(self).items() if x or name not in optional}


@dataclass(frozen=True)
class Added:
    """An effect that was added to the model; `cause` is the text of the catalogue."""

    effect: str
    cause: str
    parameters: dict[str, Estimate]
    evidence: Evidence
    torque_rms: Rms


@dataclass(frozen=True)
class Curve:
    """Time series of one log for the plots, each of shape (n,).

    `before` and `after` are the predictions of `measured`, the drive of the final model. `given` is
    the drive of the model before, which effects of the drive change. `friction` is the law's part
    of `after`. `in_motion` marks the samples whose torque the position determines; errors are of
    these.
    """

    name: str
    role: Role
    time: Array
    position: Array
    velocity: Array
    given: Array
    measured: Array
    before: Array
    after: Array
    friction: Array
    in_motion: NDArray[np.bool_]
    quantities: dict[str, Array]


@dataclass(frozen=True)
class SimulatedPosition:
    """Measured and simulated position of one log, each of shape (n,), rad (m).

    Without a controller the simulation restarts from the log every 0.5 s; there `before` and
    `after` are NaN. With a controller it follows the target from the first sample.
    """

    name: str
    role: Role
    time: Array
    measured: Array
    before: Array
    after: Array
    target: Array | None = None


@dataclass(frozen=True)
class Ranked:
    """A candidate with its cross-validated gain."""

    effect: str
    gain: float
    p_value: float


@dataclass(frozen=True)
class Looked:
    """One step of the search: the effect that was added and the next best, None if there is none,
    and all candidates, best first."""

    chosen: str | None
    runner_up: str | None
    rows: tuple[Ranked, ...]


@dataclass(frozen=True)
class Torsion:
    """The gear of one joint; an estimate is None if the logs do not show it."""

    ratio: float  # turns of the motor per turn of the link
    # by joint, turns of the motor with another joint relative to those with the link
    geared: dict[str, float]
    twist_rms: float  # without its mean, rad
    left_rms: float  # of the unexplained twist, rad
    stiffness: Estimate | None  # K, N m/rad (N/m)
    backlash: Estimate | None  # b, rad
    hysteresis: Estimate | None  # 2 h, rad
    # delay T of the link's position with respect to the motor's, s
    link_position_older: Estimate | None
