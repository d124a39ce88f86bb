"""Logs of a whole robot: every joint of every log, fitted or held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco

from frictionjoint.diagnose.report_data import LogEntry
from frictionjoint.errors import LogError
from frictionjoint.identify.held import joint_label
from frictionjoint.identify.rigid_body import ONE_DOF
from frictionjoint.measured.bounded import bounded
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import joints_with_drive

Reader = Callable[[Path, str], JointLog]


@dataclass(frozen=True)
class RobotLogs:
    """Attributes: fit, held_out: logs of each joint by its name, in the same order for all."""

    fit: dict[str, list[JointLog]]
    held_out: dict[str, list[JointLog]]

    @property
    def joints(self) -> list[str]:
        """Names, base first."""
        return list(self.fit)

    @property
    def moving(self) -> list[str]:
        """Joints whose motion the logs hold, those with a drive first."""
        names = dict.fromkeys(self.fit)
        for logs in self.fit.values():
            for log in logs:
                names |= dict.fromkeys(log.other_positions)
        return list(names)

    @property
    def entries(self) -> tuple[LogEntry, ...]:
        """Lines of the report."""
        first = self.joints[0]
        return tuple(
            LogEntry(log.name, len(log.time), log.duration, role)  # type: ignore[arg-type]
            for role, logs in (("fit", self.fit[first]), ("held-out", self.held_out[first]))
            for log in logs
        )


def read_robot(
    logs: Sequence[Path],
    held_out: Sequence[Path] | float,
    joints: Sequence[str],
    read: Reader,
) -> RobotLogs:
    """Read every joint of every log.

    Args:
        held_out: logs, or the fraction to cut off every log's end.
        joints: names. read: reads one joint of one log.
    Raises:
        LogError: see `read_log`, or the joints of a log are not of one clock.
    """
    fit: dict[str, list[JointLog]] = {}
    kept: dict[str, list[JointLog]] = {}
    for joint in joints:
        whole = [read(path, joint) for path in logs]
        if isinstance(held_out, float | int):
            pairs = [split_in_time(log, held_out) for log in whole]
            whole, rest = [a for a, _ in pairs], [b for _, b in pairs]
        else:
            rest = [read(path, joint) for path in held_out]
        fit[joint], kept[joint] = bounded(whole), bounded(rest)
    return RobotLogs(fit, kept)


def joints_to_explain(
    logs: Sequence[Path], model: mujoco.MjModel, columns: dict[str, str] | None = None
) -> list[str]:
    """Hinges and slides of a model whose drive all logs hold, base first.

    Raises:
        LogError: there is none.
    """
    found = [set(joints_with_drive(path, columns)) for path in logs]
    in_all = set.intersection(*found) if found else set()
    kinds = [(model.joint(j).name, int(model.jnt_type[j])) for j in range(model.njnt)]
    names = [name for name, kind in kinds if kind in ONE_DOF and name in in_all]
    if not names:
        held = ", ".join(sorted(set.union(*found))) if found and set.union(*found) else "none"
        has = ", ".join(joint_label(model, j) for j in range(model.njnt)) or "none"
        raise LogError(
            f"{Path(logs[0]).name}: no joint of the model has a position and a drive in every log: "
            f"the logs name {held}, the model {has}; name one with --joint"
        )
    return names
