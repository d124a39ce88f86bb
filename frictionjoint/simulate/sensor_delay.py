"""Delayed instruments: `measurement-delay` as MuJoCo's own delay of a joint's sensors.

If the position is logged late, the joint's sensors of position and velocity are delayed; if the
torque is, its sensor of the actuator force. A joint without such sensors gets them, so that
``sensordata`` contains what the instruments would have logged. Nothing else is delayed: the
simulation itself uses the true position.
"""

import math

import mujoco

_POSITION = (mujoco.mjtSensor.mjSENS_JOINTPOS, mujoco.mjtSensor.mjSENS_JOINTVEL)
_TORQUE = (mujoco.mjtSensor.mjSENS_JOINTACTFRC,)
_NAMES = {_POSITION[0]: "position", _POSITION[1]: "velocity", _TORQUE[0]: "torque"}


def delay_sensors(spec: mujoco.MjSpec, joint: str, delay: float) -> None:
    """Delay a joint's sensors, s: of the position if above 0, of the torque if below; in place."""
    late, of_joint = _POSITION if delay > 0.0 else _TORQUE, mujoco.mjtObj.mjOBJ_JOINT
    for kind, name in _NAMES.items():
        found = [s for s in spec.sensors if s.type == kind and s.objname == joint] or [
            spec.add_sensor(name=f"{joint}_{name}", type=kind, objtype=of_joint, objname=joint)
        ]
        for sensor in found if kind in late else ():
            sensor.delay = abs(delay)
            # linear between the samples that MuJoCo keeps
            sensor.interp = 1
            sensor.nsample = math.ceil(abs(delay) / spec.option.timestep) + 2
