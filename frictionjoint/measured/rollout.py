"""Rollouts in tensors of all joints: ``.pt`` and ``.npz`` of PACE, Isaac Lab, mjlab and the like.

A file contains arrays of shape (n, joints) or (n, worlds, joints), with the names that these
programs give to the data of an articulation: ``joint_pos`` or ``dof_pos`` rad, ``joint_vel`` rad/s,
``joint_pos_target`` or ``des_dof_pos`` rad, ``applied_torque`` N m. Time is ``time``, shape (n,),
s, or ``dt``, one number, or ``fps``. ``joint_names`` names the joints; without it they are
``joint_1`` ... in the file's order. ``kp`` and ``kd``, one number per joint, become metadata of the
log, for a controller with ``kp = "log:kp"``. (PACE: Bjelonic et al. 2025,
github.com/leggedrobotics/pace-sim2real.)
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import opened_npz
from frictionjoint.measured.columns import column_options, one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import ReadOptions, log_of
from frictionjoint.measured.torch_file import read_tensors

_NAMES = {
    "time_s": ("time", "times", "t", "timestamps"),
    "position_rad": ("dof_pos", "joint_pos", "joint_positions", "qpos"),
    "velocity_rad_s": ("dof_vel", "joint_vel", "joint_velocities", "qvel"),
    "target_rad": ("des_dof_pos", "joint_pos_target", "dof_pos_target", "target_joint_pos"),
    "torque_nm": ("applied_torque", "joint_torque", "dof_torque", "joint_effort", "torques"),
}
_JOINTS = ("joint_names", "dof_names")
_GAINS = ("kp", "kd")


def is_rollout(path: Path, columns: Mapping[str, str] | None) -> bool:
    """Whether a file is a rollout: .pt, or .npz with such names and no requested columns."""
    kind, is_file = path.suffix.lower(), path.is_file()
    if kind != ".npz" or not is_file or not set(columns or ()) <= {"joints", "world"}:
        return is_file and kind == ".pt"
    try:
        with opened_npz(path) as archive:
            held = set(archive)
    except LogError:  # said where it is read as a table
        return False
    drives = (*_NAMES["target_rad"], *_NAMES["torque_nm"])
    return bool(held & set(_NAMES["position_rad"])) and bool(held & set(drives))


def read_rollout(path: Path, joint: str | None, how: ReadOptions) -> JointLog:
    """Read one joint.

    Args:
        how: columns ``{"joints": "FL_hip,FL_thigh"}``, names of the joints in the file's order, and
            ``{"world": "3"}``, the index of the world if there are several.
    Raises:
        LogError: not such a file, no such joint, or see `validate`.
    """
    time, of_joints, names, gains = _read(path, how.columns)
    joint = one_joint(path.name, names, joint)
    own = names.index(joint)
    data = {"time_s": time} | {name: x[:, own] for name, x in of_joints.items()}
    for name in ("position_rad", "velocity_rad_s"):
        others = zip(names, of_joints.get(name, np.zeros((0, 0))).T, strict=False)
        data |= {f"{n}.{name}": x for n, x in others if n != joint}
    whole = {name: np.ascontiguousarray(x) for name, x in data.items()}
    log = log_of(path, joint, whole, ReadOptions(units=how.units))
    return replace(log, metadata={name: float(x[own]) for name, x in gains.items()})


def joints_of_rollout(path: Path, columns: Mapping[str, str] | None) -> list[str]:
    return _read(path, columns)[2]


def _read(
    path: Path, columns: Mapping[str, str] | None
) -> tuple[Array, dict[str, Array], list[str], dict[str, Array]]:
    """Time, (n,), arrays of shape (n, joints) by our column name, names of the joints, gains."""
    given, world = column_options(path.name, columns, ("joints", "world"), "a rollout")
    arrays, written = _arrays(path)
    arrays = {name: x.squeeze(-1) if x.shape[-1:] == (1,) else x for name, x in arrays.items()}
    found = {
        ours: arrays[name]
        for ours, names in _NAMES.items()
        if (name := next((x for x in names if x in arrays), ""))
    }
    if "position_rad" not in found or not {"target_rad", "torque_nm"} & set(found):
        wanted = "position_rad" if "position_rad" not in found else "target_rad"
        raise LogError(
            f"{path.name}: no array {_NAMES[wanted][0]!r}, it has {', '.join(arrays) or 'none'}: a "
            f"rollout contains {' or '.join(_NAMES['position_rad'][:2])}, and "
            f"{' or '.join(_NAMES['target_rad'][:2])} or {_NAMES['torque_nm'][0]}"
        )
    stamps = found.pop("time_s", None)
    of_joints = {name: _of_world(path, name, x, world) for name, x in found.items()}
    n, count = of_joints["position_rad"].shape
    time = _time(path, arrays, stamps, n)
    if any(x.shape != (n, count) for x in of_joints.values()) or time.shape != (n,):
        shapes = ", ".join(f"{name} {x.shape}" for name, x in (of_joints | {"time": time}).items())
        raise LogError(f"{path.name}: {shapes}: give one row per time and one column per joint")
    gains = {name: arrays[name] for name in _GAINS if name in arrays}
    for name, x in gains.items():
        if x.shape != (count,):
            what = f"{name} has shape {x.shape}"
            raise LogError(f"{path.name}: {what}: give one number per joint, {count}")
    names = written or [f"joint_{i + 1}" for i in range(count)]
    if given is not None:
        names = [name.strip() for name in given.split(",")]
    if len(names) != count or len(set(names)) != count or not all(names):
        what = f"it has {count} joints, but the names are {', '.join(names)}"
        fix = f"give {count} different names, --column joints=NAME,NAME"
        raise LogError(f"{path.name}: {what}: {fix}")
    return time, of_joints, names, gains


def _arrays(path: Path) -> tuple[dict[str, Array], list[str]]:
    """Arrays of numbers by name, and the joint names in the file."""
    if path.suffix.lower() == ".pt":
        return read_tensors(path), []
    with opened_npz(path) as archive:
        arrays = {name: archive[name] for name in archive}
    names = next((arrays[name] for name in _JOINTS if name in arrays), np.array([], dtype=str))
    numbers = {n: x.astype(np.float64) for n, x in arrays.items() if x.dtype.kind in "fiu"}
    return numbers, [str(name) for name in names.ravel()]


def _of_world(path: Path, name: str, x: Array, world: str | None) -> Array:
    """The joints of one world, shape (n, joints)."""
    if x.ndim == 1:
        x = x[:, None]
    if x.ndim == 3 and x.shape[1] == 1 and world is None:
        world = "0"
    if x.ndim != 3:
        return x
    if world is None or not world.isdecimal() or int(world) >= x.shape[1]:
        fix = f"name one of 0 to {x.shape[1] - 1} with --column world=N"
        raise LogError(f"{path.name}, {name}: {x.shape[1]} worlds: {fix}")
    return np.asarray(x[:, int(world)])


def _time(path: Path, arrays: Mapping[str, Array], given: Array | None, n: int) -> Array:
    if given is not None:
        return given.ravel()
    for name, invert in (("dt", False), ("fps", True)):
        if name in arrays and arrays[name].size == 1 and float(arrays[name].ravel()[0]) > 0.0:
            number = float(arrays[name].ravel()[0])
            return np.arange(n, dtype=np.float64) * (1.0 / number if invert else number)
    raise LogError(f"{path.name}: no time: give an array time, or one number dt or fps")
