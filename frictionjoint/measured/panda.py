"""The Panda log of Gaz et al. (2019): a folder of text files, seven joints per sample in turn."""

from pathlib import Path

import numpy as np

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import check_columns, check_moves

_JOINTS = tuple(f"joint{i}" for i in range(1, 8))
_PREFIX = "exciting_traj_"


def read_panda(folder: Path, joint: str | None) -> JointLog:
    """Read one joint, the others' positions beside it.

    Raises:
        LogError: an unknown joint, or a file is missing or torn.
    """
    if joint not in _JOINTS:
        raise LogError(f"{folder.name}: no joint {joint!r}, it has {', '.join(_JOINTS)}")
    parts = {}
    for name, width in (("time", 1), ("positions", 7), ("velocity", 7), ("torques", 7)):
        path = folder / f"{_PREFIX}{name}.txt"
        if not path.is_file():
            raise LogError(f"{folder.name}: no file {path.name}")
        numbers = np.loadtxt(path)
        if numbers.size % width:
            raise LogError(f"{path.name}: {numbers.size} numbers are not {width} per sample")
        parts[name] = numbers.reshape(-1, width)
    i = _JOINTS.index(joint)
    columns = {
        "time_s": parts["time"][:, 0],
        "position_rad": parts["positions"][:, i],
        "torque_nm": parts["torques"][:, i],
    }
    check_columns(folder.name, columns, 1)
    check_moves(folder.name, "position_rad", columns["position_rad"])
    others = {
        name: parts["positions"][:, k].copy() for k, name in enumerate(_JOINTS) if name != joint
    }
    return JointLog(
        name=folder.name,
        joint=joint,
        time=columns["time_s"],
        position=columns["position_rad"].copy(),
        velocity=parts["velocity"][:, i].copy(),
        torque=columns["torque_nm"].copy(),
        other_positions=others,
    )
