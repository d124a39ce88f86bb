"""Logs of a whole robot: every joint of every log, fitted or held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from frictionjoint.errors import LogError, NoMotionError, few
from frictionjoint.identify.driven_joints import joints_to_explain
from frictionjoint.measured.log import JointLog, split_each_in_time
from frictionjoint.measured.long_logs import bounded
from frictionjoint.measured.readers import read_log, require_logs
from frictionjoint.measured.validate import require_motion
from frictionjoint.model_files import compile_model
from frictionjoint.report.joint_report import LogEntry, Role

# of a log among those of a joint: its name, and how many before it have that
Place = tuple[str, int]


class Named(Protocol):
    """Anything with the name of a log."""

    @property
    def name(self) -> str:
        """Name of the log."""
        ...


_L = TypeVar("_L", bound=Named)


def by_place(logs: Sequence[_L]) -> dict[Place, _L]:
    """A joint's logs in order; the same log of another joint has the same index."""
    names = [log.name for log in logs]
    return {(log.name, names[:i].count(log.name)): log for i, log in enumerate(logs)}


@dataclass(frozen=True)
class RobotLogs:
    """Logs of each joint by its name: those in which it moves.

    Attributes:
        fit, held_out: by joint, base first. failed: why a joint's logs cannot be used, by joint.
        at_rest: names of the logs in which a joint stands still, by joint.
    """

    fit: dict[str, list[JointLog]]
    held_out: dict[str, list[JointLog]]
    failed: dict[str, str]
    at_rest: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def read(
        cls,
        joints: Sequence[str],
        logs: Sequence[str | Path],
        kept: Sequence[str | Path],
        fraction: float | None,
        read: Callable[[str | Path, str], JointLog],
    ) -> "RobotLogs":
        """Every joint's logs; long logs are decimated.

        If joints were recorded one after the other, the others stand still meanwhile. Such logs say
        nothing of their friction in motion and are left out for them.

        Args:
            joints: names, base first. logs: to fit. kept: to hold out. fraction: of each log to
                fit, to hold out at its end. read: reads one log of a joint.
        Raises:
            LogError: that of the first joint, if no joint can be used.
        """
        found = cls({}, {}, {})
        for name in joints:
            try:
                (own, still), (held_out, also) = (_in_motion(x, name, read) for x in (logs, kept))
                if not own:
                    raise next(iter(still.values()))
                if fraction is not None:
                    own, ends = split_each_in_time(own, fraction)
                    held_out = [*held_out, *ends]
                found.fit[name], found.held_out[name] = bounded(own), bounded(held_out)
                if still or also:
                    found.at_rest[name] = tuple(still | also)
            except LogError as error:
                found.failed[name] = str(error)
        if not found.fit:
            raise LogError(next(iter(found.failed.values())))
        return found

    @property
    def notes(self) -> tuple[str, ...]:
        """Logs that are left out, one sentence for all joints with the same logs left out."""
        alike: dict[tuple[str, ...], list[str]] = {}
        for joint, names in self.at_rest.items():
            alike.setdefault(names, []).append(joint)
        return tuple(
            f"{', '.join(joints)}: fitted without {few(names)}, at rest there."
            for names, joints in alike.items()
        )

    @property
    def joints(self) -> list[str]:
        """Names, base first."""
        return list(self.fit)

    @property
    def moving(self) -> list[str]:
        """Joints with logged motion, those with a drive first."""
        names = dict.fromkeys(self.fit)
        for logs in self.fit.values():
            for log in logs:
                # rad (m)
                names |= dict.fromkeys(
                    n for n, q in log.other_positions.items() if np.ptp(q) > 1e-3
                )
        return list(names)

    @property
    def entries(self) -> tuple[LogEntry, ...]:
        """Rows of the report."""
        lines: dict[tuple[Role, Place], LogEntry] = {}
        roles: list[tuple[Role, dict[str, list[JointLog]]]] = [
            ("fit", self.fit),
            ("held-out", self.held_out),
        ]
        for role, by_joint in roles:
            for logs in by_joint.values():
                for place, log in by_place(logs).items():
                    entry = LogEntry.of(log, role)
                    lines.setdefault((role, place), entry)
        return tuple(lines.values())


def _in_motion(
    paths: Sequence[str | Path], joint: str, read: Callable[[str | Path, str], JointLog]
) -> tuple[list[JointLog], dict[str, LogError]]:
    """The logs in which a joint moves, and by name why the others are excluded."""
    moves: list[JointLog] = []
    still: dict[str, LogError] = {}
    for path in paths:
        try:
            log = read(path, joint)
            require_motion(f"{log.name}, {joint}", log.position)
            moves.append(log)
        except NoMotionError as error:
            still[Path(path).stem] = error
    return moves, still


def read_robot(
    logs: Sequence[str | Path],
    model: str | Path,
    held_out: Sequence[str | Path] | float = 0.25,
    joints: Sequence[str] | None = None,
) -> RobotLogs:
    """Read every joint of every log.

    Args:
        model: path or text of the MJCF or URDF.
        held_out: logs, or the fraction of each log to hold out at its end.
        joints: names; None: all joints of the model with a logged drive.
    Raises:
        LogError: there is no log; see `read_log` and `joints_to_explain`.
    """
    require_logs(logs, held_out)
    files = held_out if not isinstance(held_out, float | int) else []
    names = joints or joints_to_explain([*logs, *files], compile_model(model))

    fraction = float(held_out) if isinstance(held_out, float | int) else None
    return RobotLogs.read(names, logs, files, fraction, read_log)
