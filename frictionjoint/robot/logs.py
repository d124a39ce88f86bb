"""Logs of a whole robot: every joint of every log, fitted or held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.diagnose.report_data import LogEntry
from frictionjoint.errors import LogError
from frictionjoint.identify.held import joint_label
from frictionjoint.measured.bounded import bounded
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import joints_with_drive, read_log, require_logs
from frictionjoint.model_files import ONE_DOF, compile_model

# travel below which a joint stands still, rad (m)
_STILL = 1e-3


@dataclass(frozen=True)
class RobotLogs:
    """Logs of each joint by its name, in the same order for all.

    Attributes:
        fit, held_out: by joint, base first. failed: why a joint's logs cannot be used, by joint.
    """

    fit: dict[str, list[JointLog]]
    held_out: dict[str, list[JointLog]]
    failed: dict[str, str]

    @classmethod
    def read(
        cls,
        joints: Sequence[str],
        read: Callable[[str], tuple[Sequence[JointLog], Sequence[JointLog]]],
    ) -> "RobotLogs":
        """Every joint's logs; what is too long is made shorter.

        Args:
            joints: names, base first. read: logs fitted and held out of a joint.
        Raises:
            LogError: of the first joint, where no joint can be used.
        """
        fit: dict[str, list[JointLog]] = {}
        kept: dict[str, list[JointLog]] = {}
        failed: dict[str, str] = {}
        for name in joints:
            try:
                fitted, held_out = read(name)
                fit[name], kept[name] = bounded(fitted), bounded(held_out)
            except LogError as error:
                failed[name] = str(error)
        if not fit:
            raise LogError(next(iter(failed.values())))
        return cls(fit, kept, failed)

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
                names |= dict.fromkeys(
                    n for n, q in log.other_positions.items() if np.ptp(q) > _STILL
                )
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
    logs: Sequence[str | Path],
    model: str | Path,
    held_out: Sequence[str | Path] | float = 0.25,
    joints: Sequence[str] | None = None,
) -> RobotLogs:
    """Read every joint of every log.

    Args:
        model: path or text of the MJCF or URDF.
        held_out: logs, or the fraction to cut off every log's end.
        joints: names; None: all of the model whose drive the logs hold.
    Raises:
        LogError: there is no log; see `read_log` and `joints_to_explain`.
    """
    require_logs(logs, held_out)
    files = held_out if not isinstance(held_out, float | int) else []
    names = joints or joints_to_explain([*logs, *files], compile_model(model))

    def read(joint: str) -> tuple[list[JointLog], list[JointLog]]:
        whole, kept = ([read_log(path, joint) for path in paths] for paths in (logs, files))
        if isinstance(held_out, float | int):
            pairs = [split_in_time(log, held_out) for log in whole]
            whole, kept = [a for a, _ in pairs], [b for _, b in pairs]
        return whole, kept

    return RobotLogs.read(names, read)


def joints_to_explain(
    logs: Sequence[str | Path], model: mujoco.MjModel, columns: dict[str, str] | None = None
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
