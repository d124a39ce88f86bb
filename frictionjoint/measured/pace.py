"""Logs of PACE (Bjelonic et al. 2025, github.com/leggedrobotics/pace-sim2real): ``.pt`` files.

A dict of tensors: ``time`` s, shape (n,), ``dof_pos`` and ``des_dof_pos`` rad, shape (n, joints).
``dof_vel`` rad/s is read where there is one, and so are ``kp`` and ``kd``, a number a joint (logs
of IIT's DLS lab): figures of the log, for a controller with ``kp = "log:kp"``. The file names no
joint: they are ``joint_1`` ... in its order, or as the column ``joints`` says.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of
from frictionjoint.measured.torch_file import read_tensors

_TIME, _POSITION, _TARGET, _VELOCITY = "time", "dof_pos", "des_dof_pos", "dof_vel"
_GAINS = ("kp", "kd")


def read_pace(path: Path, joint: str | None, columns: Mapping[str, str] | None = None) -> JointLog:
    """Read one joint.

    Args:
        columns: ``{"joints": "FL_hip,FL_thigh"}``, names of the joints in the file's order.
    Raises:
        LogError: not such a file, no such joint, or see `validate`.
    """
    found = _tensors(path)
    time, position, target = found[_TIME], found[_POSITION], found[_TARGET]
    names = _names(path, position.shape[1], columns)
    if joint is None and len(names) == 1:
        joint = names[0]
    if joint is None or joint not in names:
        what = f"no joint {joint!r}, it has" if joint else "several joints, name one of"
        raise LogError(f"{path.name}: {what} {', '.join(names)}")
    own = names.index(joint)
    data = {"time_s": time, "position_rad": position[:, own], "target_rad": target[:, own]}
    if _VELOCITY in found:
        data["velocity_rad_s"] = found[_VELOCITY][:, own]
    data |= {f"{name}.position_rad": position[:, i] for i, name in enumerate(names) if i != own}
    log = log_of(path, joint, {name: np.ascontiguousarray(x) for name, x in data.items()})
    gains = {name: float(found[name][own]) for name in _GAINS if name in found}
    return replace(log, metadata=gains)


def joints_of_pace(path: Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Names of the joints.

    Raises:
        LogError: see `read_pace`.
    """
    return _names(path, _tensors(path)[_POSITION].shape[1], columns)


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


def _tensors(path: Path) -> dict[str, Array]:
    """Time, shape (n,), what joints did, shape (n, joints), and their gains, shape (joints,)."""
    found = read_tensors(path)
    missing = [name for name in (_TIME, _POSITION, _TARGET) if name not in found]
    if missing:
        raise LogError(
            f"{path.name}: no tensor {missing[0]!r}, it has {', '.join(found) or 'none'}: a log of "
            f"PACE holds {_TIME}, {_POSITION} and {_TARGET}"
        )
    found[_TIME] = found[_TIME].ravel()
    position = found[_POSITION]
    of_joints = [name for name in (_POSITION, _TARGET, _VELOCITY) if name in found]
    alike = position.ndim == 2 and all(found[name].shape == position.shape for name in of_joints)
    if not alike or len(position) != len(found[_TIME]):
        shapes = ", ".join(f"{name} {found[name].shape}" for name in (*of_joints, _TIME))
        raise LogError(f"{path.name}: {shapes}: give a row a time and a column a joint")
    for name in _GAINS:
        if name in found and found[name].shape != position.shape[1:]:
            raise LogError(
                f"{path.name}: {name} {found[name].shape}: give it a number for each of the "
                f"{position.shape[1]} joints"
            )
    return found
