"""A joint of known inertia led along three sines, 40 s at 500 Hz."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from frictionjoint.identify.noise import Band
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.log import JointLog

INERTIA = 0.05
_MODEL = f"""<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 {INERTIA}"/></body></worldbody></mujoco>"""
_LINES = [(0.9, 0.31), (0.5, 0.73), (0.3, 1.31)]


def sines(t, lines):
    """Position, velocity and acceleration of sines of some sizes, rad, and frequencies, Hz."""
    return [
        sum(
            size * (2 * np.pi * f) ** k * np.sin(2 * np.pi * f * t + 0.5 * np.pi * k)
            for size, f in lines
        )
        for k in range(3)
    ]


T = np.arange(0.0, 40.0, 2e-3)
Q, V, A = sines(T, _LINES)


def logged(
    folder: Path,
    torque: NDArray[np.float64],
    position: NDArray[np.float64] = Q,
    band: Band | None = None,
    time: NDArray[np.float64] = T,
    temperature: NDArray[np.float64] | None = None,
) -> Prepared:
    """The log of a torque, N m, prepared with the joint's model."""
    file = folder / "j.xml"
    file.write_text(_MODEL)
    log = JointLog(name="log", joint="j", time=time, position=position, torque=torque)
    return prepare([replace(log, temperature=temperature)], RigidBody(file, "j"), band)
