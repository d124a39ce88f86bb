"""Logs of PACE (Bjelonic et al. 2025, github.com/leggedrobotics/pace-sim2real): ``.pt`` files.

A dict of tensors: ``time`` s, shape (n,), ``dof_pos`` and ``des_dof_pos`` rad, shape (n, joints).
The file names no joint: they are ``joint_1`` ... in its order, or as the column ``joints`` says.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of
from frictionjoint.measured.torch_file import read_tensors

_TIME, _POSITION, _TARGET = "time", "dof_pos", "des_dof_pos"


def read_pace(path: Path, joint: str | None, columns: Mapping[str, str] | None = None) -> JointLog:
    """Read one joint.

    Args:
        columns: ``{"joints": "FL_hip,FL_thigh"}``, names of the joints in the file's order.
    Raises:
        LogError: not such a file, no such joint, or see `validate`.
    """
    time, position, target = _tensors(path)
    names = _names(path, position.shape[1], columns)
    if joint is None and len(names) == 1:
        joint = names[0]
    if joint is None or joint not in names:
        what = f"no joint {joint!r}, it has" if joint else "several joints, name one of"
        raise LogError(f"{path.name}: {what} {', '.join(names)}")
    own = names.index(joint)
    data = {"time_s": time, "position_rad": position[:, own], "target_rad": target[:, own]}
    data |= {f"{name}.position_rad": position[:, i] for i, name in enumerate(names) if i != own}
    return log_of(path, joint, {name: np.ascontiguousarray(x) for name, x in data.items()})


def joints_of_pace(path: Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Names of the joints.

    Raises:
        LogError: see `read_pace`.
    """
    return _names(path, _tensors(path)[1].shape[1], columns)


def _names(path: Path, count: int, columns: Mapping[str, str] | None) -> list[str]:
    mapping = dict(columns or {})
    given = mapping.pop("joints", None)
    if mapping:
        raise LogError(f"{path.name}: a log of PACE takes the column joints, not {mapping}")
    if given is None:
        return [f"joint_{i + 1}" for i in range(count)]
    names = [name.strip() for name in given.split(",")]
    if len(names) != count or len(set(names)) != count or not all(names):
        raise LogError(
            f"{path.name}: it has {count} joints, joints names {', '.join(names)}: give {count} "
            "names, separated by commas"
        )
    return names


def _tensors(path: Path) -> tuple[Array, Array, Array]:
    """Time, shape (n,), positions and targets, shape (n, joints)."""
    found = read_tensors(path)
    missing = [name for name in (_TIME, _POSITION, _TARGET) if name not in found]
    if missing:
        raise LogError(
            f"{path.name}: no tensor {missing[0]!r}, it has {', '.join(found) or 'none'}: a log of "
            f"PACE holds {_TIME}, {_POSITION} and {_TARGET}"
        )
    time, position, target = (found[name] for name in (_TIME, _POSITION, _TARGET))
    time = time.ravel()
    if position.ndim != 2 or position.shape != target.shape or len(position) != len(time):
        shapes = f"{_POSITION} {position.shape}, {_TARGET} {target.shape}, {_TIME} {time.shape}"
        raise LogError(f"{path.name}: {shapes}: give a row a time and a column a joint")
    return time, position, target
