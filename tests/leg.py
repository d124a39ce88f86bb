"""A leg's joint under a PD controller of known gains: target and position are logged, no torque."""

import numpy as np

from frictionjoint.control import Controller
from frictionjoint.measured.log import JointLog

KP, KD, TICK = 20.0, 1.5, 1e-3
CONTROLLER = Controller(output="torque_nm", kp=KP, kd=KD)
BELIEVED, VISCOUS, LEVEL = 0.006, 0.5, 0.25
MODEL = f"""<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="0.1" diaginertia="{BELIEVED} {BELIEVED} {BELIEVED}"/></body>
</worldbody></mujoco>"""


def leg(inertia: float, seconds: int = 16) -> JointLog:
    """A leg's joint that swings quickly under a PD controller, at 200 Hz."""
    n = 1000 * seconds
    time = TICK * np.arange(n)
    target = 0.3 * np.sin(2.0 * np.pi * 1.3 * time) + 0.15 * np.sin(2.0 * np.pi * 3.1 * time + 0.7)
    position = np.empty(n)
    q = v = 0.0
    for k in range(n):
        position[k] = q
        torque = KP * (target[k] - q) - KD * v
        torque -= VISCOUS * v + LEVEL * np.tanh(v / 0.01)
        v += TICK * torque / inertia
        q += TICK * v
    noise = 2e-4 * np.random.default_rng(3).standard_normal(n)
    kept = slice(None, None, 5)
    return JointLog(
        name="leg", joint="j", time=time[kept], position=(position + noise)[kept],
        target=target[kept],
    )  # fmt: skip
