"""The Panda log of Gaz et al. (2019): a folder of text files, seven joints per sample in order.

``exciting_traj_time.txt`` s, ``..._positions.txt`` rad, ``..._velocity.txt`` rad/s,
``..._torques.txt`` N m at the joint's torque sensor, gravity included; one number per line.
"""

from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line
from frictionjoint.measured.columns import one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of
from frictionjoint.measured.validate import check_finite

JOINTS = tuple(f"joint{i}" for i in range(1, 8))
_FILES = {"time": 1, "positions": 7, "velocity": 7, "torques": 7}


def is_panda(folder: Path) -> bool:
    """Whether a folder contains such a log."""
    return _file(folder, "time").is_file() or _file(folder, "positions").is_file()


def read_panda(folder: Path, joint: str | None) -> JointLog:
    """Read one joint, with the motion of the others.

    Raises:
        LogError: an unknown joint, or a file is missing or corrupt.
    """
    parts = {name: _numbers(_file(folder, name), width) for name, width in _FILES.items()}
    joint = one_joint(folder.name, JOINTS, joint)
    own = JOINTS.index(joint)
    quantities = {"position_rad": "positions", "velocity_rad_s": "velocity"}
    columns = {"time_s": parts["time"][:, 0].copy(), "torque_nm": parts["torques"][:, own].copy()}
    for i, name in enumerate(JOINTS):
        prefix = "" if i == own else f"{name}."
        columns |= {f"{prefix}{c}": parts[file][:, i].copy() for c, file in quantities.items()}
    return log_of(folder, joint, columns)


def _file(folder: Path, name: str) -> Path:
    return folder / f"exciting_traj_{name}.txt"


def _numbers(path: Path, width: int) -> Array:
    """Samples of one file, shape (n, width)."""
    try:
        numbers = np.loadtxt(path, dtype=np.float64, ndmin=1)
    except OSError:
        raise LogError(f"{path.parent.name}: no file {path.name}, put it there") from None
    except ValueError as error:
        raise LogError(f"{path.name}: not one number per line: {one_line(error)}") from None
    if numbers.ndim != 1 or numbers.size == 0 or numbers.size % width:
        raise LogError(f"{path.name}: {numbers.size} numbers are not {width} per sample")
    check_finite(path.name, "number", numbers, lambda i: i + 1)
    return numbers.reshape(-1, width)
