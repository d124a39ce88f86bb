"""Results for a robot, and for several of one kind, as plain data: the content of report.json."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.parameter_meanings import MEANINGS, by_direction, meaning
from frictionjoint.report.entries import Evidence, LogEntry, content_of, table_of
from frictionjoint.report.joint_report import Report, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "frictionjoint/report-2"
UNITS_SCHEMA = "frictionjoint/units-1"


@dataclass(frozen=True)
class Excitation:
    """A trajectory."""

    joints: tuple[str, ...]
    slides: tuple[bool, ...]  # whether each joint is a slide
    time: Array  # s, shape (n,)
    q: Array  # positions, shape (n, joints)
    # ratio of the standard errors of the base parameters after and before it: median, and that of
    # the parameter with the largest error
    fall: tuple[float, float]

    def csv(self) -> str:
        """The motion as a CSV file with a column of targets per joint."""
        names = [
            f"{n}.target_{'m' if slide else 'rad'}"
            for n, slide in zip(self.joints, self.slides, strict=True)
        ]
        table, text = np.column_stack([self.time, self.q]), StringIO()
        np.savetxt(text, table, "%.6g", ",", header=",".join(["time_s", *names]), comments="")
        return text.getvalue()

    @property
    def text(self) -> str:
        """The benefit of the motion, in a sentence."""
        fall = (
            "should reduce the standard errors of the base parameters by "
            f"{1.0 - self.fall[0]:.0%} (median), the largest one by {1.0 - self.fall[1]:.0%}."
        )
        seconds = f"{self.time[-1]:.3g} s"
        if min(self.fall) > 0.9:
            return (
                f"Nothing in particular: {seconds} more would add little. The best motion within "
                f"the limits of range, speed and torque, next_trajectory.csv, {fall}"
            )
        return f"The motion in next_trajectory.csv ({seconds}). It {fall}"


@dataclass(frozen=True)
class SharedCause:
    """A cause in the model that acts on several joints: body or joints where it is, by key, and
    torque errors of the joints where it acts, without and with it."""

    cause: str
    place: dict[str, str]
    parameters: dict[str, Estimate]
    evidence: Evidence
    joints: dict[str, tuple[Rms, Rms]]

    def to_dict(self) -> dict[str, Any]:
        errors = {
            name: {"before": {"torque_rms": before}, "after": {"torque_rms": after}}
            for name, (before, after) in self.joints.items()
        }
        own = {"parameters": self.parameters, "evidence": self.evidence, "joints": errors}
        return {"cause": self.cause} | self.place | own


@dataclass(frozen=True)
class RobotErrors:
    """Errors of the robot: torque in per cent of each joint's rms torque, averaged over joints, and
    position of free runs of all joints together, rms, rad (m)."""

    torque_percent: Rms
    replay_rms: Rms


@dataclass(frozen=True, repr=False)
class RobotReport:
    """Result of `close_loop` for several joints.

    Attributes follow report.json. `failed`: one line per joint without a result.
    `excitation`: what to record next; None if no motion is within the robot's limits.
    """

    logs: tuple[LogEntry, ...]
    joints: dict[str, Report]
    failed: dict[str, str]
    shared: tuple[SharedCause, ...]
    before: RobotErrors
    after: RobotErrors
    undetermined: tuple[dict[str, Any], ...]
    excitation: Excitation | None = field(repr=False)
    mjcf: str = field(repr=False)
    seconds: float
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        joints = ", ".join(f"{n}: {x.verdict}" for n, x in self.joints.items())
        failed = f", failed: {', '.join(self.failed)}" if self.failed else ""
        return f"RobotReport({joints}{failed})"

    def summary(self) -> str:
        """Verdict, shared causes and a table of the joints as text."""
        from frictionjoint.report.text import summary_text

        return summary_text(self.to_dict())

    def plot(self) -> "Figure":
        """Torque of the worst held-out stretch and friction-speed curve per joint (matplotlib)."""
        from frictionjoint.report.picture import draw_robot

        return draw_robot(self)

    @property
    def verdict(self) -> Verdict:
        """`explained` if no joint has anything left to explain, nor an error above the noise."""
        found = {joint.verdict for joint in self.joints.values()}
        if self.failed or any(joint.worse for joint in self.joints.values()):
            return "partly-explained"
        if len(found) == 1 and not self.shared:
            return found.pop()
        left = any(joint.above_noise for joint in self.joints.values())
        known = found <= {"explained", "no-effect-found"} and not left
        return "explained" if known else "partly-explained"

    def to_dict(self) -> dict[str, Any]:
        names = ("logs", "joints", "failed", "shared", "before", "after", "undetermined")
        joints = {name: joint.in_robot() for name, joint in self.joints.items()}
        own = {name: getattr(self, name) for name in names} | {"joints": joints}
        proposals = [self.excitation.text] if self.excitation else []
        end = {"proposals": proposals, "notes": list(self.notes), "verdict": self.verdict}
        return {"schema": SCHEMA, **table_of(own), **end}


def mean_percent(pairs: list[tuple[Rms, Rms]]) -> Rms:
    """Errors as percentages of the rms of the drive on the same logs, averaged over joints, from
    the two of each joint."""

    def mean(role: str) -> float | None:
        values = [(getattr(error, role), getattr(drive, role)) for error, drive in pairs]
        known = [error / size for error, size in values if error is not None and size]
        return 100.0 * float(np.mean(known)) if known else None

    return Rms(mean("fit"), mean("held_out"))


def notes_of(joints: Mapping[str, Report]) -> tuple[str, ...]:
    """Notes of the joints, each with its joint's name unless all share it."""
    whose: dict[str, list[str]] = {}
    for name, joint in joints.items():
        for note in joint.notes:
            whose.setdefault(note, []).append(name)
    return tuple(
        note if len(names) == len(joints) else f"{', '.join(names)}: {note}"
        for note, names in whose.items()
    )


@dataclass(frozen=True)
class Spread:
    """A parameter of a joint, or of a shared cause with its place (`owner`), that several units
    have: estimates by the unit's name, in the same SI unit."""

    owner: str
    name: str
    unit: str
    of_unit: dict[str, Estimate]

    @property
    def mean(self) -> float:
        return float(np.mean([x.value for x in self.of_unit.values()]))

    @property
    def deviation(self) -> float:
        """Standard deviation over units; 0 for one unit."""
        values = [x.value for x in self.of_unit.values()]
        return float(np.std(values, ddof=1)) if len(values) > 1 else 0.0

    @property
    def error(self) -> float | None:
        """Expected deviation if all units were equal: rms of the standard errors; None if one is
        unknown."""
        errors = [x.stderr for x in self.of_unit.values()]
        known = [e for e in errors if e is not None]
        return root_mean_square(np.array(known)) if len(known) == len(errors) else None

    def to_dict(self) -> dict[str, Any]:
        return {
            "of": self.owner,
            "parameter": self.name,
            "unit": self.unit,
            "mean": self.mean,
            "deviation": self.deviation,
            "standard_error": self.error,
            "units": content_of(self.of_unit),
        }


@dataclass(frozen=True)
class UnitsReport:
    """Result of `close_loop_units`: a report by the unit's name, and one line per unit without a
    result."""

    units: dict[str, RobotReport]
    failed: dict[str, str]

    @property
    def spreads(self) -> tuple[Spread, ...]:
        """Parameters of the final friction laws, joint by joint, then of the shared causes.

        Parameters of a single unit are left out.
        """
        rows: dict[tuple[str, str, str], dict[str, Estimate]] = {}
        for unit, report in self.units.items():
            for joint, own in report.joints.items():
                for name, x in own.final.items():
                    rows.setdefault((joint, name, x.unit), {})[unit] = x
            for cause in report.shared:
                owner = " of ".join(filter(None, (cause.cause, " and ".join(cause.place.values()))))
                for name, x in cause.parameters.items():
                    rows.setdefault((owner, name, x.unit), {})[unit] = x
        return tuple(Spread(*key, found) for key, found in rows.items() if len(found) > 1)

    @property
    def rows(self) -> tuple[tuple[str, Spread], ...]:
        """Each spread with its parameter in words; one for both directions if they are equal."""
        owners: dict[tuple[str, str], dict[str, Spread]] = {}
        for x in self.spreads:
            owners.setdefault((x.owner, x.unit), {})[x.name] = x
        found = []
        for (_, unit), own in owners.items():
            for symbol, name in by_direction(own, lambda a, b: a.of_unit == b.of_unit):
                known = symbol.partition("_")[0] in MEANINGS
                words = meaning(symbol) if known else symbol
                found.append((words if unit == "1" else f"{words}, {unit}", own[name]))
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        return {
            "schema": UNITS_SCHEMA,
            "units": content_of(self.units),
            "failed": self.failed,
            "spread": content_of(self.spreads),
        }
