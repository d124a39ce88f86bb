"""Joints of a model whose friction logs can show."""

from collections.abc import Sequence
from pathlib import Path

import mujoco

from frictionjoint.errors import NO_JOINT, LogError, ModelError, few
from frictionjoint.identify.held import joint_label
from frictionjoint.measured.readers import joints_with_drive
from frictionjoint.model_files import ONE_DOF


def joints_to_explain(
    logs: Sequence[str | Path], model: mujoco.MjModel, columns: dict[str, str] | None = None
) -> list[str]:
    """Hinges and slides of a model with a drive in all logs, base first.

    Columns that name no joint are those of the only joint of a model.

    Raises:
        ModelError: the model has none.
        LogError: a log has none of those in the model and in the logs before it.
    """
    has = [joint_label(model, j) for j in range(model.njnt) if int(model.jnt_type[j]) in ONE_DOF]
    if not has:
        raise ModelError(NO_JOINT)
    names = has
    for path in logs:
        driven = joints_with_drive(path, columns) or (has if len(has) == 1 else [])
        common = [name for name in names if name in driven]
        if not common:
            source = "model" if names is has else "model and of the logs before it"
            raise LogError(
                f"{Path(path).name}: no joint of the {source} has a position and a drive here: "
                f"wanted is one of {few(names, 12)}, the columns name "
                f"{few(driven, 12) or 'none'}; name one joint with --joint, or its columns "
                "--column JOINT.position_rad=NAME"
            )
        names = common
    return names
