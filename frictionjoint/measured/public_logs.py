"""Public logs in formats of their own: EMPS, ODrive, Panda and Staubli TX40; see public_logs.toml.

EMPS, a prismatic axis driven by a motor of known force constant (Janot et al. 2019), is a .mat file
with ``t`` s, ``qm`` position m, ``qg`` reference m, ``vir`` motor voltage V, ``gtau`` N/V,
controller gains ``kp`` and ``kv``. Force = gtau * vir.

Anti-cogging recordings of a bare motor on an ODrive (Chen et al.) are .npy with three rows: time s,
encoder counts (8192 per turn), motor current A. The current is a torque up to the motor's torque
constant, which the file does not contain.

The Panda log of Gaz et al. (2019) is a folder of text files, seven joints per sample in order:
``exciting_traj_time.txt`` s, ``..._positions.txt`` rad, ``..._velocity.txt`` rad/s,
``..._torques.txt`` N m at the joint's torque sensor, gravity included; one number per line.

The Staubli TX40 log of figaroh-examples is a folder with two tables, no time column, 5 kHz.
``pos_read_data.csv``: motor positions, rad. ``curr_data.csv``: motor currents as the drives report
them, in units that the authors treat as motor torques, N m. Columns ``Joint_1`` to ``Joint_6`` of
the file are joints ``joint_1`` to ``joint_6`` of the robot's URDF. Joint positions are inverse(K)
times motor positions and, by virtual work, joint torques are transpose(K) times motor torques. The
wrist is coupled: motor 6 also turns with joint 5.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured import text_table
from frictionjoint.measured.arrays import mat_columns, mat_names, one_line, whole
from frictionjoint.measured.columns import one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of
from frictionjoint.measured.text_layout import layout_of
from frictionjoint.measured.validate import check_finite

_EMPS = {"time_s": "t", "position_m": "qm", "target_m": "qg", "force_n": "vir"}
_ODRIVE_RAD_PER_COUNT = 2 * np.pi / 8192
_PANDA = tuple(f"joint{i}" for i in range(1, 8))
# numbers per sample in each file
_PANDA_FILES = {"time": 1, "positions": 7, "velocity": 7, "torques": 7}
_PANDA_FILE = "exciting_traj_{}.txt"
_TX40_COLUMNS = [f"Joint_{i}" for i in range(1, 7)]
_TX40 = tuple(name.lower() for name in _TX40_COLUMNS)
_TX40_POSITIONS, _TX40_CURRENTS = "pos_read_data.csv", "curr_data.csv"
_K = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
_K[5, 4] = 32.0


def is_emps(names: list[str]) -> bool:
    """Whether a .mat file has the variable names of the EMPS."""
    return {*_EMPS.values(), "gtau"} <= set(names)


def read_emps(path: Path) -> JointLog:
    there = mat_names(path)
    scalars = [name for name in ("gtau", "kp", "kv") if name in there]
    raw = mat_columns(path, [*_EMPS.values(), *scalars])
    for name in scalars:
        if raw[name].size != 1:
            raise LogError(f"{path.name}, {name}: {raw[name].size} numbers, one is needed")
    gains: dict[str, float] = {name: float(raw[name][0]) for name in scalars}
    columns = {ours: raw[theirs] for ours, theirs in _EMPS.items()}
    columns["force_n"] = gains["gtau"] * columns["force_n"]
    return replace(log_of(path, "joint", columns), metadata=gains)


def read_odrive(path: Path) -> JointLog:
    """One recording of the ODrive; rows in messages are samples, from 1. LogError: another file."""
    with whole(path):
        rows = np.load(path, allow_pickle=False)
    if not isinstance(rows, np.ndarray) or rows.ndim != 2 or len(rows) != 3:
        raise LogError(f"{path.name}: needs three rows: time s, encoder counts, current A")
    if rows.dtype.kind not in "fiu":
        raise LogError(f"{path.name}: {rows.dtype} are not numbers")
    time, counts, current = rows.astype(np.float64)
    columns = {"time_s": time, "position_rad": counts * _ODRIVE_RAD_PER_COUNT, "current_a": current}
    return log_of(path, "joint", columns)


def joints_of_folder(folder: Path) -> tuple[str, ...]:
    """Names of the joints in the Panda's or the TX40's log; none in other folders."""
    if any((folder / _PANDA_FILE.format(x)).is_file() for x in ("time", "positions")):
        return _PANDA
    return _TX40 if (folder / _TX40_POSITIONS).is_file() else ()


def read_folder(folder: Path, joint: str | None) -> JointLog:
    """Read one joint of the Panda's or the TX40's log; LogError for another folder, an unknown
    joint, a missing or corrupt file, or see `validate`."""
    joints = joints_of_folder(folder)
    if not joints:
        known = "ROS 2 bag, LeRobot data set, Panda or TX40 log"
        raise LogError(f"{folder.name}: a folder, but no {known}: name a file in it")
    return _read_panda(folder, joint) if joints == _PANDA else _read_tx40(folder, joint)


def _read_panda(folder: Path, joint: str | None) -> JointLog:
    """One joint, with the motion of the others."""
    parts = {name: _panda_numbers(folder, name, width) for name, width in _PANDA_FILES.items()}
    joint = one_joint(folder.name, _PANDA, joint)
    own = _PANDA.index(joint)
    quantities = {"position_rad": "positions", "velocity_rad_s": "velocity"}
    columns = {"time_s": parts["time"][:, 0].copy(), "torque_nm": parts["torques"][:, own].copy()}
    for i, name in enumerate(_PANDA):
        prefix = "" if i == own else f"{name}."
        columns |= {f"{prefix}{c}": parts[file][:, i].copy() for c, file in quantities.items()}
    return log_of(folder, joint, columns)


def _panda_numbers(folder: Path, name: str, width: int) -> Array:
    """Samples of one file, shape (n, width)."""
    path = folder / _PANDA_FILE.format(name)
    try:
        numbers = np.loadtxt(path, dtype=np.float64, ndmin=1)
    except OSError:
        raise LogError(f"{folder.name}: no file {path.name}, put it there") from None
    except ValueError as error:
        raise LogError(f"{path.name}: not one number per line: {one_line(error)}") from None
    if numbers.ndim != 1 or numbers.size == 0 or numbers.size % width:
        raise LogError(f"{path.name}: {numbers.size} numbers are not {width} per sample")
    check_finite(path.name, "number", numbers, lambda i: i + 1)
    return numbers.reshape(-1, width)


def _read_tx40(folder: Path, joint: str | None) -> JointLog:
    name = one_joint(folder.name, _TX40, joint and joint.lower())
    motor = _tx40_columns(folder / _TX40_POSITIONS)
    current = _tx40_columns(folder / _TX40_CURRENTS)
    if len(motor) != len(current):
        sizes = f"{_TX40_POSITIONS} has {len(motor)} samples, {_TX40_CURRENTS} {len(current)}"
        raise LogError(f"{folder.name}: {sizes}")
    position, torque = np.linalg.solve(_K, motor.T), _K.T @ current.T
    own = _TX40.index(name)
    columns = {"time_s": np.arange(len(motor)) / 5000.0, "position_rad": position[own]}
    columns |= {"motor_position_rad": motor[:, own].copy(), "torque_nm": torque[own]}
    columns |= {f"{_TX40[i]}.position_rad": position[i] for i in range(6) if i != own}
    return log_of(folder, name, columns)


def _tx40_columns(path: Path) -> Array:
    """Columns of all six joints, shape (n, 6)."""
    names = layout_of(path).names
    missing = [name for name in _TX40_COLUMNS if name not in names]
    if missing:
        needed = ", ".join(_TX40_COLUMNS)
        raise LogError(f"{path.name}: no column {missing[0]!r}, it needs {needed}")
    columns = text_table.read_columns(path, _TX40_COLUMNS)
    return np.column_stack([columns[name] for name in _TX40_COLUMNS])
