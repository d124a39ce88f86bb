"""Integrate a joint under its firmware, finely: semi-implicit Euler, 20 to 50 us a step."""

import math

import numpy as np
from numba import njit

from .drive import Drive
from .firmware import OUTPUT, TICKS, Firmware, begin, cycle
from .friction import ELEMENTS, Friction, viscous_coefficient
from .joint import Joint
from .laws import hysteresis
from .load import Load, load_torque

SETTLING = 2.5  # s at the first target before a log begins
SMOOTHING = 0.004  # s, time constant of the torque that loads the gear
Q, V, TRANSMITTED, STEPS = range(4)  # entries of the body's state


@njit
def _step(
    load: Load, f: Friction, drive: Drive, output: float, body: np.ndarray, z: np.ndarray, h: float
) -> None:
    """One step; linear damping acts implicitly, the presliding spring as position does."""
    q, v = body[Q], body[V]
    outer = load_torque(load, q)
    held = hysteresis(f, z, v, h, body[TRANSMITTED])
    push = drive.factor * drive.gain * output + outer - held
    damping = drive.emf + viscous_coefficient(f, v)
    body[V] = (load.inertia * v + h * push) / (load.inertia + h * damping)
    body[Q] = q + h * body[V]
    passing = load.link * (body[V] - v) / h - outer
    body[TRANSMITTED] += h / SMOOTHING * (passing - body[TRANSMITTED])
    body[STEPS] += 1.0


@njit
def _run(
    load: Load,
    f: Friction,
    drive: Drive,
    fw: Firmware,
    kp: float,
    target: np.ndarray,
    period: float,
    steps: int,
    body: np.ndarray,
    z: np.ndarray,
    memory: np.ndarray,
) -> np.ndarray:
    """Position and speed at each sample of `target`, (n, 2); states go on where they were."""
    h = period / steps
    path = np.empty((target.size, 2))
    for k in range(target.size):
        path[k, 0], path[k, 1] = body[Q], body[V]
        for i in range(steps):
            if body[STEPS] * h >= fw.phase + memory[TICKS] * fw.period - 1e-9:
                late = math.floor((k * steps + i - fw.delay / h) / steps + 1e-9)
                cycle(fw, kp, memory, target[max(late, 0)], body[Q], body[V])
            _step(load, f, drive, memory[OUTPUT], body, z, h)
    return path


def motion(
    joint: Joint,
    kp: float,
    target: np.ndarray,
    period: float,
    start: tuple[float, float] | None = None,
    settling: float = SETTLING,
) -> tuple[np.ndarray, np.ndarray]:
    """Motion from rest at the first target: while settling and during the log, each (n, 2).

    The joint settles first; a `start` then replaces its position and speed, while friction and
    firmware keep what they hold.
    """
    steps = math.ceil(period / joint.step - 1e-9)
    first = float(target[0])
    body, z = np.array((first, 0.0, 0.0, 0.0)), np.zeros(ELEMENTS)
    memory = begin(joint.firmware, first, first)
    plant = (joint.load, joint.friction, joint.drive, joint.firmware, float(kp))

    def run(course: np.ndarray) -> np.ndarray:
        return _run(*plant, course, float(period), steps, body, z, memory)

    before = run(np.full(round(settling / period), first))
    if start is not None:
        body[Q], body[V] = start
    return before, run(np.ascontiguousarray(target, dtype=float))
