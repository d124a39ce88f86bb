"""Joints that a log does not measure, held at their assumed positions.

A compiled model is changed in place. The position is built into the frames of the bodies, so that
new data of the model contain it. The joint is locked by an armature that no torque can move.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError, few

# Position of a hinge or slide; of a ball its quaternion, of a free joint position and quaternion.
Pose: TypeAlias = float | Sequence[float]

FREE, BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)
SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)
# numbers in a pose, where it is more than one, and what they are
_MANY = {
    FREE: (7, "a free joint needs x,y,z and the quaternion w,x,y,z"),
    BALL: (4, "a ball joint needs the quaternion w,x,y,z"),
}


def joint_label(model: mujoco.MjModel, j: int) -> str:
    """Name of a joint, or a description of a joint without a name."""
    body = model.body(int(model.jnt_bodyid[j])).name
    return str(model.joint(j).name or f"unnamed joint of body {body!r}")


def resolve(
    model: mujoco.MjModel, joint_id: int, fixed: Mapping[str, Pose] | None
) -> dict[int, Array]:
    """Positions by the index of the joint; ModelError: no such joint, the examined one, which
    cannot be held, or not a position of its kind."""
    found = {}
    for name, value in (fixed or {}).items():
        j = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        if j < 0:
            names = few([joint_label(model, i) for i in range(model.njnt)], 12)
            raise ModelError(f"--fixed {name}: no such joint in the MJCF, it has {names}")
        if j == joint_id:
            raise ModelError(f"--fixed {name}: this is the joint to identify, it is in the log")
        found[j] = _pose(name, int(model.jnt_type[j]), value)
    return found


def _pose(name: str, kind: int, value: Pose) -> Array:
    numbers, what = _MANY.get(kind, (1, "give one number, rad or m"))
    try:
        pose = np.atleast_1d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError):
        pose = np.full(1, np.nan)
    if pose.shape != (numbers,) or not np.isfinite(pose).all():
        raise ModelError(f"--fixed {name}={value}: {what}")
    if numbers > 1:
        size = float(np.linalg.norm(pose[-4:]))
        if size == 0.0:
            raise ModelError(f"--fixed {name}={value}: its quaternion is zero, {what}")
        pose[-4:] /= size
    return pose


def take_pose(model: mujoco.MjModel, poses: Mapping[int, Array]) -> None:
    """Change a model's initial pose: joints by index, and everything attached to them."""
    # free and ball joints turn from their frame itself, hinges and slides from the initial pose
    shifted = {j for j in poses if int(model.jnt_type[j]) not in _MANY}
    for body in {int(model.jnt_bodyid[j]) for j in shifted}:
        first = int(model.body_jntadr[body])
        position, turn = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
        for j in reversed(range(first, first + int(model.body_jntnum[body]))):
            own = _displacement(model, j, poses[j]) if j in shifted else None
            # what comes after a joint in its body goes before it now: its axis, seen from there
            back = np.zeros(4)
            mujoco.mju_negQuat(back, turn)
            model.jnt_pos[j] = _turned(model.jnt_pos[j] - position, back)
            model.jnt_axis[j] = _turned(model.jnt_axis[j], back)
            if own:
                position, turn = _after(*own, position, turn)
        frame = (model.body_pos[body].copy(), model.body_quat[body].copy())
        model.body_pos[body], model.body_quat[body] = _after(*frame, position, turn)
    for j, pose in poses.items():
        address = int(model.jnt_qposadr[j])
        model.qpos0[address : address + len(pose)] = pose
    if poses:
        mujoco.mj_setConst(model, mujoco.MjData(model))


def lock(model: mujoco.MjModel, *free: int) -> None:
    """Hold every joint of a model, except some given by index, where it is."""
    others = ~np.isin(model.dof_jntid, free)
    # kg m^2, kg: 1 kN m turns such a joint by 0.2 mrad in an hour
    model.dof_armature[others] = 1e13
    mujoco.mj_setConst(model, mujoco.MjData(model))


def _displacement(model: mujoco.MjModel, j: int, pose: Array) -> tuple[Array, Array]:
    """Translation and quaternion, in the frame of the body, of a hinge or slide moved to a pose."""
    moved = float(pose[0] - model.qpos0[model.jnt_qposadr[j]])
    turn = np.array([1.0, 0.0, 0.0, 0.0])
    if int(model.jnt_type[j]) == SLIDE:
        return moved * model.jnt_axis[j], turn
    mujoco.mju_axisAngle2Quat(turn, model.jnt_axis[j], moved)
    anchor = model.jnt_pos[j].copy()
    return anchor - _turned(anchor, turn), turn


def _after(p: Array, q: Array, position: Array, turn: Array) -> tuple[Array, Array]:
    """The pose (position, turn) seen from a frame at (p, q), in that frame's own parent."""
    both = np.zeros(4)
    mujoco.mju_mulQuat(both, q, turn)
    return p + _turned(position, q), both


def _turned(x: Array, turn: Array) -> Array:
    out = np.zeros(3)
    mujoco.mju_rotVecQuat(out, np.ascontiguousarray(x), np.ascontiguousarray(turn))
    return out
