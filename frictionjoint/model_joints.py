"""What a compiled model says of its joints."""

import mujoco
import numpy as np

from frictionjoint.arrays import Array

_SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)
_ON_A_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))


def is_slide(model: mujoco.MjModel, joint: str) -> bool:
    """Whether a joint is a slide."""
    return int(model.joint(joint).type[0]) == _SLIDE


def count_of_actuators(model: mujoco.MjModel) -> int:
    """Number of actuators, including a `dcmotor` without input, which has no control."""
    return len(model.actuator_group)


def actuators_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Actuators that act on a joint directly."""
    number = model.joint(joint).id
    return [
        i
        for i in range(count_of_actuators(model))
        if model.actuator_trntype[i] in _ON_A_JOINT and model.actuator_trnid[i, 0] == number
    ]


def mass_at_start(model: mujoco.MjModel) -> Array:
    """Mass matrix at qpos0, with armature, shape (nv, nv)."""
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    # mj_fullM takes other arguments in other versions
    for row, unit in zip(mass, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    return mass
