"""The fine-step loop: controller, friction, thermal body, MuJoCo's mj_step, sampling.

Compiled by numba, calling `mj_step` of the MuJoCo library itself through its C address, so every
rigid-body part, spring, gap and motor is stepped by MuJoCo and no callback is in use.
"""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import mujoco
from numba import njit

from .friction import bristle, gms, stribeck


def _library() -> ctypes.CDLL:
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in folder.glob(pattern):
            return ctypes.CDLL(str(path))
    raise RuntimeError(f"no MuJoCo library in {folder}")


_mj_step = _library().mj_step
_mj_step.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
_mj_step.restype = None

# Names of the numbers the loop takes, in their order in the array `c`, with neutral defaults.
FIELDS = {
    "h": 1e-4, "law": 0.0, "Fs": 0.0, "Fc": 0.0, "Vs": 0.1, "delta": 1.0, "sigma2": 0.0,
    "asymmetry": 0.0, "sigma0": 1.0, "sigma1": 0.0, "attraction": 1.0,
    "kp": 0.0, "ki": 0.0, "kd": 0.0, "limit": 1e9, "actual_limit": 1e9, "hold": 10.0,
    "gravity": 0.0, "link_inertia": 0.0,
    "load": 0.0,
    "visc2": 0.0, "visc_p": 2.0,
    "bias": 0.0,
    "heat": 0.0, "cooling_tau": 1.0, "temp0": 25.0, "ambient": 25.0,
    "visc_T": 0.0, "level_T": 0.0, "T0": 20.0,
    "lag_tau": 0.0,
    "dwell": 0.0, "dwell_tau": 1.0, "dwell_slip": 1e-3,
    "level_factor": 1.0,
    "gust_amp": 0.0, "gust_freq": 0.0, "gust_phase": 0.0,
    "periodic_level": 0.0, "periodic_n": 1.0, "periodic_phase": 0.0,
    "voltage": 0.0, "other_kp": 0.0, "other_kd": 0.0,
}  # fmt: skip
INDEX = {name: i for i, name in enumerate(FIELDS)}
(_H, _LAW, _FS, _FC, _VS, _DELTA, _SIGMA2, _ASYM, _S0, _S1, _ATTR, _KP, _KI, _KD, _LIMIT, _ACTUAL,
 _HOLD, _GRAV, _JLINK, _LOAD, _VISC2, _VISCP, _BIAS, _HEAT, _COOL, _TEMP0, _AMBIENT, _VISCT,
 _LEVELT, _T0, _LAGTAU, _DWELL, _DWELLTAU, _DWELLSLIP, _FACTOR, _GUST, _GUSTF, _GUSTP, _PLEVEL,
 _PN, _PPHASE, _VOLT, _OKP, _OKD) = range(len(FIELDS))  # fmt: skip
PLAIN = 3


@njit(cache=True)
def _level(c, q, v, load, temp, rested, lagged):  # type: ignore[no-untyped-def]
    """Sliding level S, N m, with everything that scales it; `lagged` is the slow state of it."""
    breakaway = c[_FS] + c[_DWELL] * rested
    s = stribeck(v, breakaway, c[_FC], c[_VS], c[_DELTA])
    s *= 1.0 + c[_ASYM] if v > 0.0 else 1.0 - c[_ASYM]
    s *= c[_FACTOR] * (1.0 + c[_LEVELT] * math.exp(-(temp - 25.0) / c[_T0]))
    s *= 1.0 + c[_PLEVEL] * math.sin(c[_PN] * q + c[_PPHASE])
    if c[_LAGTAU] > 0.0:
        lagged[0] += (s - lagged[0]) * c[_H] / (c[_LAGTAU] + c[_H])
        s = lagged[0]
    return s + c[_LOAD] * abs(load)


@njit(cache=True)
def _viscous(c, v, temp):  # type: ignore[no-untyped-def]
    """Viscous torque, N m: linear part falling with temperature, and a power law."""
    sigma2 = c[_SIGMA2] + c[_VISCT] * math.exp(-(temp - 25.0) / c[_T0])
    power = c[_VISC2] * abs(v) ** c[_VISCP]
    return sigma2 * v + (power if v > 0.0 else -power)


@njit(cache=True)
def sliding(c, k, alpha, z, slip, q, dx, v, load, temp, rested, lagged, last):  # type: ignore[no-untyped-def]
    """Level and torque of the joint's own friction after a displacement, viscous part included.

    MuJoCo's own friction takes the level instead, and adds its torque itself.
    """
    level = _level(c, q, v, load, temp, rested, lagged)
    if c[_LAW] == 0.0:
        fric = gms(z, slip, dx, v, c[_H], level, k, alpha, c[_ATTR], c[_S1], last)
    elif c[_LAW] == PLAIN:
        fric = 0.0
    else:
        plateau = 0.5 if c[_LAW] == 2.0 else 0.0
        fric = bristle(z, dx, c[_H], level, c[_S0], c[_S1], plateau)
    return level, fric + _viscous(c, v, temp)


@njit(cache=True)
def behind(c, load, q, a):  # type: ignore[no-untyped-def]
    """What the gear hands on to the link; 1 ms low pass, as teeth and shaft have."""
    asked = c[_GRAV] * math.sin(q) + c[_JLINK] * a
    return load + (asked - load) * c[_H] / (1e-3 + c[_H])


@njit(cache=True)
def worn(c, level, fric, v, temp, rested):  # type: ignore[no-untyped-def]
    """Temperature and share of aged contact a step later."""
    h = c[_H]
    # MuJoCo's own friction is none of `fric`, and warms the joint no less
    lost = abs(fric * v) + (level * abs(v) if c[_LAW] == PLAIN else 0.0)
    temp += h * (c[_HEAT] * lost - (temp - c[_AMBIENT]) / c[_COOL])
    rested += h * (1.0 - rested) / c[_DWELLTAU] - abs(v) * h / c[_DWELLSLIP] * rested
    return temp, max(rested, 0.0)


@njit
def run(model, data, c, k, alpha, z, slip, target, other_target, qpos, qvel, qacc, applied, ctrl,
        loss, drive, sample_at, look_at, out):  # type: ignore[no-untyped-def]  # fmt: skip
    """Step the plant through `target` (one value per control period) and fill `out`.

    out columns: joint position, command, temperature, target, other joint's position.
    `sample_at` are step numbers of the samples, `look_at` those at which position is read.
    `drive` is 1 where ctrl[0] is a voltage handed to MuJoCo's dcmotor, else torque is applied.
    """
    h, hold = c[_H], int(c[_HOLD])
    integral, load, temp, rested, last, speed = 0.0, 0.0, c[_TEMP0], 1.0, 0.0, 0.0
    lagged = z[-1:]
    elements = z[:-1]
    lagged[0] = c[_FS]
    q_old, command, fric, taken, looked = qpos[0], 0.0, 0.0, 0, 0
    for n in range(target.size * hold):
        if n % hold == 0:
            error = target[n // hold] - qpos[0]
            speed += 0.3 * (qvel[0] - speed)
            integral += c[_KI] * error * h * hold
            command = c[_KP] * error + integral - c[_KD] * speed
            if abs(command) > c[_LIMIT]:
                command = math.copysign(c[_LIMIT], command)
                integral -= c[_KI] * error * h * hold
        v, dx = qvel[0], qpos[0] - q_old
        q_old = qpos[0]
        level, fric = sliding(
            c, k, alpha, elements, slip, q_old, dx, v, load, temp, rested, lagged, last
        )
        if c[_LAW] == PLAIN:
            loss[0] = level
        if v != 0.0:
            last = v
        gust = c[_GUST] * math.sin(c[_GUSTF] * n * h + c[_GUSTP])
        given = min(max(command, -c[_ACTUAL]), c[_ACTUAL])
        applied[0] = c[_BIAS] + gust - fric
        if drive == 1:
            ctrl[0] = given
        else:
            applied[0] += given
        if other_target.size > 0:
            applied[-1] = c[_OKP] * (other_target[n // hold] - qpos[-1]) - c[_OKD] * qvel[-1]
        if taken < sample_at.size and sample_at[taken] == n:
            out[taken, 1], out[taken, 2], out[taken, 3] = command, temp, target[n // hold]
            taken += 1
        while looked < look_at.size and look_at[looked] == n:
            out[looked, 0], out[looked, 4] = qpos[0], qpos[-1]
            looked += 1
        _mj_step(model, data)
        load = behind(c, load, qpos[0], qacc[0])
        temp, rested = worn(c, level, fric, v, temp, rested)
