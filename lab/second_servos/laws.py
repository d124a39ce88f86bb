"""Hysteresis torque of four friction laws, each with the update that suits it.

Speed is held over a step of at most 50 us. Every function changes the state `z` in place and
returns the torque that opposes positive motion, N m.
"""

import math

import numpy as np
from numba import njit

from .friction import DAHL, ELASTOPLASTIC, ELEMENTS, LUGRE, Friction, level


@njit
def _fading_damping(f: Friction, v: float) -> float:
    """Damping of the presliding spring, gone in sliding so that friction stays passive."""
    return f.damping * math.exp(-((v / f.damping_speed) ** 2))


@njit
def _lugre(f: Friction, z: np.ndarray, v: float, h: float, transmitted: float) -> float:
    """Canudas de Wit et al. (1995); the bristle relaxes exactly at constant speed."""
    if v == 0.0:
        return f.static / f.presliding * z[0]
    stiffness = f.static / f.presliding
    side = 1.0 if v > 0.0 else -1.0
    end = side * level(f, v, side, transmitted) / stiffness
    before = z[0]
    z[0] = end + (before - end) * math.exp(-abs(v) * h / abs(end))
    return stiffness * z[0] + _fading_damping(f, v) * (z[0] - before) / h


@njit
def _maxwell(f: Friction, z: np.ndarray, v: float, h: float, transmitted: float) -> float:
    """Elements in parallel that stick and slip at equal shares of the Stribeck level.

    Each breaks away after 1.5 times the displacement of the one before, the last at standstill
    after three times the presliding displacement, where a LuGre bristle is at 95% of its level.
    """
    upper = level(f, v, 1.0, transmitted) / ELEMENTS
    lower = level(f, v, -1.0, transmitted) / ELEMENTS
    reach = 3.0 * f.presliding
    torque = 0.0
    for i in range(ELEMENTS):
        stiffness = f.static / ELEMENTS / reach
        pull = min(max(stiffness * (z[i] + v * h), -lower), upper)
        z[i] = pull / stiffness
        torque += pull
        reach /= 1.5
    return torque + _fading_damping(f, v) * v


@njit
def _elastoplastic(f: Friction, z: np.ndarray, v: float, h: float, transmitted: float) -> float:
    """Dupont et al. (2002): no plastic motion below breakaway, hence no drift; sub-stepped."""
    stiffness = f.static / f.presliding
    if v == 0.0:
        return stiffness * z[0]
    side = 1.0 if v > 0.0 else -1.0
    end = level(f, v, side, transmitted) / stiffness
    first = f.breakaway * end
    before = z[0]
    steps = 1 + min(int(abs(v) * h / (0.1 * end)), 40)
    move = min(abs(v) * h, 4.0 * end) / steps
    x = side * before  # deflection along the motion
    for _ in range(steps):
        if x <= first:
            plastic = 0.0
        elif x >= end:
            plastic = 1.0
        else:
            plastic = 0.5 + 0.5 * math.sin(math.pi * (x - 0.5 * (end + first)) / (end - first))
        x += move * (1.0 - plastic * x / end)
    z[0] = side * x
    return stiffness * z[0] + _fading_damping(f, v) * (z[0] - before) / h


@njit
def _dahl(f: Friction, z: np.ndarray, v: float, h: float, transmitted: float) -> float:
    """Dahl's (1968) saturating spring in units of its level, times the Stribeck level."""
    side = 1.0 if v > 0.0 else -1.0
    if v != 0.0:
        z[0] = side + (z[0] - side) * math.exp(-abs(v) * h / f.presliding)
    direction = 1.0 if z[0] > 0.0 else -1.0
    return z[0] * level(f, v, direction, transmitted) + _fading_damping(f, v) * v


@njit
def hysteresis(f: Friction, z: np.ndarray, v: float, h: float, transmitted: float) -> float:
    """Hysteresis torque after a step h at speed v, N m; `z` is the state."""
    if f.law == LUGRE:
        return _lugre(f, z, v, h, transmitted)
    if f.law == ELASTOPLASTIC:
        return _elastoplastic(f, z, v, h, transmitted)
    if f.law == DAHL:
        return _dahl(f, z, v, h, transmitted)
    return _maxwell(f, z, v, h, transmitted)
