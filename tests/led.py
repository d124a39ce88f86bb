"""A joint of MuJoCo that a controller leads along a target."""

import mujoco
import numpy as np


def led(model: mujoco.MjModel, target: np.ndarray, kp: float, kd: float = 0.0, bears: bool = False):
    """Torque and position of the joint at each step of the target; bears: its weight as well."""
    data, torque, position = mujoco.MjData(model), np.empty_like(target), np.empty_like(target)
    for k in range(len(target)):
        position[k] = data.qpos[0]
        torque[k] = kp * (target[k] - data.qpos[0]) - kd * data.qvel[0] + bears * data.qfrc_bias[0]
        data.qfrc_applied[0] = torque[k]
        mujoco.mj_step(model, data)
    return torque, position
