"""A joint behind a controller whose torque is limited and late, integrated in short steps."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.measured.log import JointLog

SAMPLE, STEPS = 0.002, 20  # s; steps of the integration in each
KP, KD, LIMIT, LATE = 100.0, 1.0, 60.0, 0.002
MODEL_INERTIA, MISSING = 0.03, 0.02
CONTROLLER = Controller(kp=KP, kd=KD, output="torque_nm")
MODEL = f"""
<mujoco><worldbody><body><joint name="j" axis="0 0 1" armature="0.005"/>
<inertial pos="0 0 0" mass="1" diaginertia="{MODEL_INERTIA - 0.005} 0.01 {MODEL_INERTIA - 0.005}"/>
</body></worldbody></mujoco>
"""


def recorded(amplitude: float, seconds: float = 16.0) -> JointLog:
    """A chirp of the target from 0.5 to 8 Hz, rad, with Coulomb and viscous friction."""
    t = SAMPLE * np.arange(round(seconds / SAMPLE))
    target = amplitude * np.sin(2.0 * np.pi * (0.5 * t + 0.5 * 7.5 / seconds * t**2))
    name = f"{amplitude:g} rad"
    return JointLog(name=name, joint="j", time=t, position=_moved(target), target=target)


def _moved(target: Array) -> Array:
    h, inertia, level, viscous = SAMPLE / STEPS, MODEL_INERTIA + MISSING, 0.4, 0.017
    late = round(LATE / h)
    asked, x, v, places = [0.0] * late, 0.0, 0.0, []
    for row in target.tolist():
        places.append(x)
        for _ in range(STEPS):
            asked.append(min(LIMIT, max(-LIMIT, KP * (row - x) - KD * v)))
            v += h * (asked[-late - 1] - viscous * v) / inertia
            held = h * level / inertia
            v = 0.0 if abs(v) <= held else v - held * np.sign(v)
            x += h * v
    return np.array(places)
