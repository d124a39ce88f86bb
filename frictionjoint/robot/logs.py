"""Logs of one joint or of a whole robot: every joint of every log, fitted or held out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar, get_args

import numpy as np

from frictionjoint.errors import LogError, ModelError, NoMotionError, few
from frictionjoint.identify.matching import joints_to_explain
from frictionjoint.identify.segment import Segment
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.long_logs import shortened
from frictionjoint.measured.readers import read_log
from frictionjoint.measured.validate import require_motion
from frictionjoint.model_files import compile_model
from frictionjoint.report.entries import LogEntry, Role

LogLike = JointLog | str | Path
# of a log among those of a joint: its name, and how many before it have that
Place = tuple[str, int]
_Log = TypeVar("_Log", JointLog, Segment)


def by_place(logs: Sequence[_Log]) -> dict[Place, _Log]:
    """A joint's logs in order; the same log of another joint has the same index."""
    names = [log.name for log in logs]
    return {(log.name, names[:i].count(log.name)): log for i, log in enumerate(logs)}


@dataclass(frozen=True)
class RobotLogs:
    """Logs of each joint by its name: those in which it moves.

    Attributes:
        fit, held_out: by joint, base first. failed: why a joint's logs cannot be used, by joint.
        at_rest: names of the logs in which a joint stands still, by joint.
        alone: whether the user named one joint, not a robot.
        ends: whether the ends of fitted logs are held out.
    """

    fit: dict[str, list[JointLog]]
    held_out: dict[str, list[JointLog]]
    failed: dict[str, str]
    at_rest: dict[str, tuple[str, ...]] = field(default_factory=dict)
    alone: bool = False
    ends: bool = False

    @classmethod
    def read(
        cls,
        logs: Sequence[LogLike],
        kept: Sequence[LogLike],
        fraction: float | None,
        model: str | Path | Mapping[str, str | Path],
        joint: str | Sequence[str] | None = None,
        read: Callable[[str | Path, str], JointLog] = read_log,
        columns: dict[str, str] | None = None,
    ) -> "RobotLogs":
        """Every joint's logs; long logs are decimated. Logs in which a joint stands still, because
        the joints were recorded one after the other, are left out for it.

        Args:
            logs: to fit. kept: to hold out. fraction: of each log to fit, to hold out at its end.
            joint: name of one joint, whose logs are all needed; names, base first; None: all joints
                of the model with a logged drive.
            read: reads one log of a joint. columns: see `read_log`.
        Raises:
            LogError: no log to fit, a named joint cannot be used or is named twice, or no joint can
                be used; see `joints_to_explain`.
        """
        if not logs:
            raise LogError("no log to fit: give at least one that is not held out")
        found = cls({}, {}, {}, alone=isinstance(joint, str), ends=fraction is not None)
        if isinstance(joint, str):
            own, held_out = (
                [x if isinstance(x, JointLog) else read(x, joint) for x in some]
                for some in (logs, kept)
            )
            found._add(joint, own, held_out, fraction)
            for log in found.fit[joint]:
                require_motion(f"{log.name}, {joint}", log.position)
            return found
        files = [x for x in (*logs, *kept) if not isinstance(x, JointLog)]
        if len(files) < len(logs) + len(kept):
            raise LogError("the logs of a robot are files: give paths, or the name of one joint")
        if isinstance(model, Mapping):
            raise ModelError("several joints share one model: give its path, without patterns")
        if joint and len(set(joint)) < len(joint):
            raise LogError(f"joints {', '.join(joint)}: one is named twice, name it once")
        for name in joint or joints_to_explain(files, compile_model(model), columns):
            try:
                parts = files[: len(logs)], files[len(logs) :]
                (own, still), (held_out, also) = (_in_motion(x, name, read) for x in parts)
                if not own:
                    raise next(iter(still.values()))
                found._add(name, own, held_out, fraction)
                if still or also:
                    found.at_rest[name] = tuple(still | also)
            except LogError as error:
                if joint:  # named by the user, so the result must contain it
                    raise
                found.failed[name] = str(error)
        if not found.fit:
            raise LogError(next(iter(found.failed.values())))
        return found

    def _add(
        self, joint: str, own: list[JointLog], held_out: list[JointLog], fraction: float | None
    ) -> None:
        if fraction is not None:
            parts = [split_in_time(log, fraction) for log in own]
            own, held_out = [first for first, _ in parts], [*held_out, *(end for _, end in parts)]
        self.fit[joint], self.held_out[joint] = shortened(own), shortened(held_out)

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
        others = (x.other_positions.items() for logs in self.fit.values() for x in logs)
        # rad (m)
        moved = (n for positions in others for n, q in positions if np.ptp(q) > 1e-3)
        return list(dict.fromkeys((*self.fit, *moved)))

    @property
    def entries(self) -> tuple[LogEntry, ...]:
        """Rows of the report."""
        lines: dict[tuple[Role, Place], LogEntry] = {}
        for role, by_joint in zip(get_args(Role), (self.fit, self.held_out), strict=True):
            for logs in by_joint.values():
                for place, log in by_place(logs).items():
                    lines.setdefault((role, place), LogEntry.of(log, role))
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
