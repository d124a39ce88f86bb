"""Joints of a model whose friction logs can show."""

from collections.abc import Sequence
from pathlib import Path

import mujoco

from frictionjoint.errors import LogError, few
from frictionjoint.identify.held import joint_label
from frictionjoint.measured.readers import joints_with_drive
from frictionjoint.model_files import ONE_DOF


def joints_to_explain(
    logs: Sequence[str | Path], model: mujoco.MjModel, columns: dict[str, str] | None = None
) -> list[str]:
    """Hinges and slides of a model with a drive in all logs, base first.

    Raises:
        LogError: there is none.
    """
    found = [set(joints_with_drive(path, columns)) for path in logs]
    in_all = set.intersection(*found) if found else set()
    kinds = [(model.joint(j).name, int(model.jnt_type[j])) for j in range(model.njnt)]
    names = [name for name, kind in kinds if kind in ONE_DOF and name in in_all]
    if not names:
        held = few(sorted(set.union(*found)) if found else [], 12) or "none"
        has = few([joint_label(model, j) for j in range(model.njnt)], 12) or "none"
        raise LogError(
            f"{Path(logs[0]).name}: no joint of the model has a position and a drive in every log: "
            f"the logs name {held}, the model {has}; name one with --joint"
        )
    return names
