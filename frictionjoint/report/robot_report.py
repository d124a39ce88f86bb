"""Results for a whole robot as plain data: the content of report.json and of the pages."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.report.content import content_of
from frictionjoint.report.joint_report import Evidence, LogEntry, Report, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "frictionjoint/report-2"
# part of a joint's squares that a cause may add to them: a cause that is there harms no joint
HARM = 0.05
Interval = tuple[float, float]


@dataclass(frozen=True)
class Torsion:
    """The gear of one joint.

    Attributes:
        ratio: turns of the motor per turn of the link. twist: rms without its mean, rad.
        geared: by joint, turns of the motor with another joint relative to those with the link.
        left: rms of the unexplained twist, rad.
        stiffness: K, N m/rad (N/m). backlash: b, rad. hysteresis: 2 h, rad. older: delay T of the
            link's position with respect to the motor's, s. Each is None if the logs do not show it.
    """

    ratio: float
    geared: dict[str, float]
    twist: float
    left: float
    stiffness: Estimate | None
    backlash: Estimate | None
    hysteresis: Estimate | None
    older: Estimate | None

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "ratio": self.ratio,
            "geared": self.geared,
            "twist_rms": self.twist,
            "left_rms": self.left,
            "stiffness": self.stiffness,
            "backlash": self.backlash,
            "hysteresis": self.hysteresis,
            "link_position_older": self.older,
        }


@dataclass(frozen=True)
class Excitation:
    """A trajectory.

    Attributes:
        joints: names. slides: whether each is a slide.
        time: s, shape (n,). q: positions, shape (n, joints).
        fall: ratio of the standard errors of the base parameters after and before it: median and
            smallest.
    """

    joints: tuple[str, ...]
    slides: tuple[bool, ...]
    time: Array
    q: Array
    fall: tuple[float, float]

    def csv(self) -> str:
        """The motion as a CSV file with a column of targets per joint."""
        names = [
            f"{n}.target_{'m' if slide else 'rad'}"
            for n, slide in zip(self.joints, self.slides, strict=True)
        ]
        rows = [",".join(["time_s", *names])]
        for t, q in zip(self.time, self.q, strict=True):
            rows.append(",".join(f"{x:.6g}" for x in (t, *q)))
        return "\n".join(rows) + "\n"

    @property
    def text(self) -> str:
        """The benefit of the motion, in a sentence."""
        fall = (
            "should reduce the standard errors of the base parameters to "
            f"{self.fall[0]:.0%} of the present ones (median; the largest one to "
            f"{self.fall[1]:.0%})."
        )
        seconds = f"{self.time[-1]:.3g} s"
        if min(self.fall) > 0.9:
            return (
                f"nothing in particular: {seconds} more would add little. The best motion within "
                f"the limits of range, speed and torque, next_trajectory.csv, {fall}"
            )
        return f"the motion in next_trajectory.csv ({seconds}). It {fall}"


@dataclass(frozen=True)
class JointResult:
    """Result of one joint.

    Attributes:
        report: of `close_loop` with the corrected model.
        base, law: the law alone with the user's model, and its name.
        before_torque, before_replay: its errors. measured_rms: of the torque, as the report's.
        increase: 95% paired interval of the increase of each held-out error that increased:
            "torque_rms", "replay_rms".
        torsion: between motor and link, if both have an encoder.
    """

    report: Report = field(repr=False)
    base: dict[str, Estimate]
    law: str
    before_torque: Rms
    before_replay: Rms
    increase: Mapping[str, Interval] = field(default_factory=dict)
    torsion: Torsion | None = None

    @property
    def shared_before(self) -> bool:
        """Whether the user's model and the corrected one differ before effects are added."""
        return self.before_torque != self.report.before_torque

    @property
    def worse(self) -> tuple[str, ...]:
        """Held-out errors that are clearly larger after the change of the model.

        The increase must exceed its confidence interval, and the squared error must grow by a
        noticeable fraction. No shared cause may add such an increase to a joint.
        """
        pairs = {
            "torque_rms": (self.before_torque.held_out, self.report.after_torque.held_out),
            "replay_rms": (self.before_replay.held_out, self.report.after_replay.held_out),
        }
        found = []
        for name, (low, _) in self.increase.items():
            before, after = pairs[name]
            assert before is not None
            assert after is not None
            if low > 0.0 and after**2 > (1.0 + HARM) * before**2:
                found.append(name)
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json: report-1 without the parts that belong to the robot."""
        found = self.report.to_dict()
        for key in ("schema", "joint", "logs"):
            del found[key]
        found["base"] = content_of({"law": self.law, "parameters": self.base})
        found["before"] = content_of(
            {"torque_rms": self.before_torque, "replay_rms": self.before_replay}
        )
        if self.shared_before:
            # errors before are those of the user's model, of which no interval is known
            for pair in found["intervals"].values():
                if pair:
                    del pair["before"]
            for row in found["log_errors"]:
                row["before"] = None
        found["measured_rms"] = self.report.measured_rms
        found["increase"] = {
            name: [x if np.isfinite(x) else None for x in interval]
            for name, interval in self.increase.items()
        }
        found["worse"] = list(self.worse)
        if self.torsion:
            found["torsion"] = content_of(self.torsion)
        return found


@dataclass(frozen=True)
class SharedCause:
    """A cause in the model that acts on several joints.

    Attributes:
        place: body or joints where it is, by key.
        joints: torque errors of the joints where it acts, without and with it.
    """

    cause: str
    place: dict[str, str]
    parameters: dict[str, Estimate]
    evidence: Evidence
    joints: dict[str, tuple[Rms, Rms]]

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        errors = {
            name: {"before": {"torque_rms": before}, "after": {"torque_rms": after}}
            for name, (before, after) in self.joints.items()
        }
        own = {"parameters": self.parameters, "evidence": self.evidence, "joints": errors}
        return {"cause": self.cause} | self.place | own


@dataclass(frozen=True)
class RobotErrors:
    """Errors of the robot.

    Attributes:
        torque_percent: of each joint's rms torque, averaged over joints.
        replay: rms position error of free runs of all joints together, rad (m).
    """

    torque_percent: Rms
    replay: Rms

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "torque_percent": self.torque_percent.to_dict(),
            "replay_rms": self.replay.to_dict(),
        }


@dataclass(frozen=True, repr=False)
class RobotReport:
    """Result of `close_loop` for several joints.

    Attributes follow report.json. `failed`: one line per joint without a result.
    `excitation`: what to record next; None if no motion is within the robot's limits.
    """

    logs: tuple[LogEntry, ...]
    joints: dict[str, JointResult]
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
        joints = ", ".join(f"{n}: {x.report.verdict}" for n, x in self.joints.items())
        failed = f", failed: {', '.join(self.failed)}" if self.failed else ""
        return f"RobotReport({joints}{failed})"

    def summary(self) -> str:
        """Verdict, shared causes and a table of the joints as text."""
        from frictionjoint.report.text import robot_text

        return robot_text(self.to_dict())

    def plot(self) -> "Figure":
        """Torque of the worst held-out stretch and friction-speed curve per joint (matplotlib)."""
        from frictionjoint.report.picture import draw_robot

        return draw_robot(self)

    @property
    def verdict(self) -> Verdict:
        """`explained` if every joint is explained or has nothing to explain."""
        found = {result.report.verdict for result in self.joints.values()}
        if self.failed or any(result.worse for result in self.joints.values()):
            return "partly-explained"
        if len(found) == 1 and not self.shared:
            return found.pop()
        return "explained" if found <= {"explained", "no-effect-found"} else "partly-explained"

    def to_dict(self) -> dict[str, Any]:
        """The content of report.json."""
        names = ("logs", "joints", "failed", "shared", "before", "after", "undetermined")
        found: dict[str, Any] = content_of({name: getattr(self, name) for name in names})
        proposals = [self.excitation.text] if self.excitation else []
        end = {"proposals": proposals, "notes": list(self.notes), "verdict": self.verdict}
        return {"schema": SCHEMA, **found, **end}


def mean_percent(pairs: list[tuple[Rms, Rms]]) -> Rms:
    """Errors as percentages of the rms of the drive on the same logs, averaged over joints.

    Args:
        pairs: error and drive of each joint.
    """

    def mean(values: list[tuple[float | None, float | None]]) -> float | None:
        known = [error / size for error, size in values if error is not None and size]
        return 100.0 * float(np.mean(known)) if known else None

    return Rms(
        mean([(error.fit, drive.fit) for error, drive in pairs]),
        mean([(error.held_out, drive.held_out) for error, drive in pairs]),
    )


def notes_of(results: Mapping[str, JointResult]) -> tuple[str, ...]:
    """Notes of the joints, each with its joint's name unless all share it."""
    whose: dict[str, list[str]] = {}
    for name, result in results.items():
        for note in result.report.notes:
            whose.setdefault(note, []).append(name)
    everyone = len(results)
    return tuple(
        note if len(names) == everyone else f"{', '.join(names)}: {note}"
        for note, names in whose.items()
    )
