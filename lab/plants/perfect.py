"""What a true model leaves: the plant's own law and link driven by the logged motion.

A log tells a motion by samples of an encoder. Between them, and below a count, nobody knows how the
joint moved. Presliding, and a link that is thrown to and fro in a gap, turn that into torque: this
much a model that is true leaves too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from . import loop
from .parts import JOINT
from .plant import Trial, assemble, constants
from .spec import GRAVITY, PlantSpec


def truth_error(trial: Trial, number: int, time: NDArray, acceleration: NDArray) -> NDArray:
    """Error of the true friction and the true link along one log, N m, at `time`.

    Args:
        number: of the log. time: s on the clock of the log. acceleration: of the logged motion
            there, rad/s^2, from which the load of the gear follows.
    """
    parts, log, h = assemble(trial.spec), trial.logs[number], trial.spec.step
    position = log.get("position_rad", log.get(f"{JOINT}.position_rad"))
    late = log["time_s"] - parts.delay
    fine = np.arange(late[0], late[-1], h)
    motion = CubicSpline(late, position)
    q, a = motion(fine), np.interp(fine, time, acceleration)
    friction = np.zeros(fine.size)
    k, alpha = parts.elements()
    loop.replay(constants(parts, number), k, alpha, q, a, friction)
    error = np.interp(log["time_s"], fine, friction) - trial.inside[number][:, 0]
    if parts.shaft is not None:
        link = np.zeros(fine.size)
        inertia, weights, angles = _link(trial.spec, parts.extra_mass, parts.extra_angle)
        stiffness, half = _spring(trial.spec)
        damping = float(parts.shaft["damping"])
        loop.swing(h, inertia, weights, angles, stiffness, damping, half, q, a, link)
        error += np.interp(log["time_s"], fine, link) - trial.inside[number][:, 1]
    return np.asarray(np.interp(time, log["time_s"], error))


def _link(spec: PlantSpec, mass: float, angle: float) -> tuple[float, NDArray, NDArray]:
    """Inertia of the link, and the weights that hang at angles from it, N m, rad."""
    weights = np.array([spec.gravity_torque, mass * GRAVITY * spec.arm])
    return spec.inertia + mass * spec.arm**2, weights, np.array([0.0, angle])


def _spring(spec: PlantSpec) -> tuple[float, float]:
    """Stiffness between motor and link, N m/rad, and half of the gap, rad."""
    (shaft,) = (e.parameters for e in spec.effects if e.name in ("joint-elasticity", "backlash"))
    return shaft["stiffness"], 0.5 * shaft.get("gap", 0.0)
