"""The Staubli TX40 log of figaroh-examples: a folder with two tables, no time column, 5 kHz.

``pos_read_data.csv``: motor positions, rad. ``curr_data.csv``: motor currents as the drives report
them, in units that the authors treat as motor torques, N m. Columns ``Joint_1`` to ``Joint_6`` of
the file are joints ``joint_1`` to ``joint_6`` of the robot's URDF. Joint positions are inverse(K)
times motor positions and, by virtual work, joint torques are transpose(K) times motor torques. The
wrist is coupled: motor 6 also turns with joint 5.
"""

from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured import text_table
from frictionjoint.measured.columns import one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

_POSITIONS, _CURRENTS = "pos_read_data.csv", "curr_data.csv"
_IN_FILE = [f"Joint_{i}" for i in range(1, 7)]
JOINTS = [name.lower() for name in _IN_FILE]
_K = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
_K[5, 4] = 32.0


def is_tx40(folder: Path) -> bool:
    """Whether a folder contains such a log."""
    return (folder / _POSITIONS).is_file()


def read_tx40(folder: Path, joint: str | None) -> JointLog:
    """Read one joint.

    Raises:
        LogError: an unknown joint, a missing file, or see `validate`.
    """
    name = one_joint(folder.name, JOINTS, joint and joint.lower())
    motor = _six(folder / _POSITIONS)
    current = _six(folder / _CURRENTS)
    if len(motor) != len(current):
        raise LogError(
            f"{folder.name}: {_POSITIONS} has {len(motor)} samples, {_CURRENTS} {len(current)}"
        )
    position, torque = np.linalg.solve(_K, motor.T), _K.T @ current.T
    own = JOINTS.index(name)
    columns = {
        "time_s": np.arange(len(motor)) / 5000.0,
        "position_rad": position[own],
        "motor_position_rad": motor[:, own].copy(),
        "torque_nm": torque[own],
    }
    columns |= {f"{JOINTS[i]}.position_rad": position[i] for i in range(6) if i != own}
    return log_of(folder, name, columns)


def _six(path: Path) -> Array:
    """Columns of all six joints, shape (n, 6)."""
    missing = [name for name in _IN_FILE if name not in text_table.header(path)]
    if missing:
        raise LogError(f"{path.name}: no column {missing[0]!r}, it needs {', '.join(_IN_FILE)}")
    columns = text_table.read_columns(path, _IN_FILE)
    return np.column_stack([columns[name] for name in _IN_FILE])
