"""A whole log in closed loop: the servo's control law and MuJoCo, given nothing but the target."""

from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError, ModelError
from frictionjoint.measured.log import JointLog
from frictionjoint.simulate.attach import attach

_LONGEST_STEP = 1e-3


@dataclass(frozen=True)
class Servo:
    """Firmware that drives a motor towards a target: V = supply clip(gain (target - q), -1, 1).

    Attributes:
        gain: duty per rad (m). supply: V at full duty.
    """

    gain: float
    supply: float

    def voltage(self, target: float, position: float) -> float:
        """V at the motor's leads."""
        duty = min(1.0, max(-1.0, self.gain * (target - position)))
        return self.supply * duty


def run_servo(model: mujoco.MjModel, joint: str, log: JointLog, servo: Servo) -> Array:
    """The motion that a log's target makes: friction, motor and control law are simulated.

    The joint starts where and as fast as it was measured, its friction at rest and never moved.
    The motor is let go where the log's `torque_enabled` says so. Other actuators are off.

    Args:
        model: carries friction and a motor, as the loop writes it for logs of voltages. Its time
            step and its disabled actuators are changed for the run only.
    Returns:
        position at the log's times, rad (m), shape (n,).
    Raises:
        ModelError: no friction, or no motor on the joint. LogError: the log has no target.
    """
    if log.target is None:
        raise LogError(f"{log.name}: no target to follow, add target_rad")
    motor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, f"{joint}_voltage")
    if motor < 0:
        raise ModelError(f"joint {joint!r} has no voltage motor: fit logs with voltage_v")
    all_off = (1 << 31) - 1  # bits of the 31 actuator groups
    alone = all_off & ~(1 << int(model.actuator_group[motor]))
    j = model.joint(joint).id
    qpos, dof = int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])
    begin = log.time[0]
    steps = max(1, int(np.ceil(log.duration / min(_LONGEST_STEP, model.opt.timestep))))
    h = log.duration / steps
    time = begin + h * np.arange(steps + 1)
    target = np.interp(time, log.time, log.target)
    closed = np.ones(len(time), dtype=bool)
    if log.torque_enabled is not None:
        closed = log.torque_enabled[np.searchsorted(log.time, time + 1e-9 * h, side="right") - 1]
    before = model.opt.timestep, model.opt.disableactuator
    data = mujoco.MjData(model)
    data.qpos[qpos] = log.position[0]
    data.qvel[dof] = 0.0 if log.velocity is None else log.velocity[0]
    found = np.empty(len(time))
    model.opt.timestep = h
    try:
        with attach(model):
            for k in range(len(time)):
                found[k] = data.qpos[qpos]
                model.opt.disableactuator = alone if closed[k] else all_off
                data.ctrl[motor] = servo.voltage(target[k], found[k])
                mujoco.mj_step(model, data)
    finally:
        model.opt.timestep, model.opt.disableactuator = before
    return np.interp(log.time, time, found)
