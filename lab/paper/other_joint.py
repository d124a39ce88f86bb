"""A joint that is not ours: the KUKA's first axis with Maxwell-slip or LuGre friction.

Integrated by a fixed fine step with the test joints' own friction (lab/plants), no kernel of the
package. Levels, inertia and offset are those of the model notes of the KUKA IR 361; what is not
published (breakaway, Stribeck velocity, presliding reach) is chosen as in models/.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from plants.friction import ATTRACTION, bristle, gms, maxwell_elements, stribeck

Array = NDArray[np.float64]

INERTIA = 23.8  # kg m^2
Fs, Fc, Vs, DELTA, SIGMA2 = 51.0, 34.26, 0.05, 2.0, 10.78
OFFSET = -12.72  # N m
REACH = 1e-3  # rad over which the virgin curve rises to Fs
SIGMA1 = 300.0
ENCODER = 2.0 * np.pi / 4096 / 94.14706  # rad a count
TORQUE_NOISE = 0.3  # N m
LAWS = ("generalised Maxwell-slip", "LuGre")
_STEP = 1e-5
_SIGMA0 = 3e5  # N m/rad, of LuGre


@njit(cache=True)
def _run(target, hold, kp, kd, k, alpha, lugre):  # type: ignore[no-untyped-def]
    """Position, velocity and drive torque at each target sample; semi-implicit Euler."""
    z, slip = np.zeros(k.size), np.zeros(k.size, dtype=np.bool_)
    q = v = last = dx = 0.0
    out = np.zeros((3, target.size))
    for i in range(target.size):
        torque = kp * (target[i] - q) - kd * v
        out[0, i], out[1, i], out[2, i] = q, v, torque
        for _ in range(hold):
            level = stribeck(v, Fs, Fc, Vs, DELTA)
            if lugre:
                friction = bristle(z, dx, _STEP, level, _SIGMA0, SIGMA1, 0.0)
            else:
                friction = gms(z, slip, dx, v, _STEP, level, k, alpha, ATTRACTION, SIGMA1, last)
            if v != 0.0:
                last = v
            v += _STEP * (torque - OFFSET - friction - SIGMA2 * v) / INERTIA
            dx = _STEP * v
            q += dx
    return out


def run(law: str, target: Array, dt: float, kp: float, kd: float) -> tuple[Array, Array, Array]:
    """Position rad, velocity rad/s and drive torque N m under a position controller.

    Args:
        law: one of LAWS.
        target: rad, one value every `dt` s, held. kp, kd: N m/rad, N m s/rad.
    """
    k, alpha = maxwell_elements(Fs, REACH)
    q, v, torque = _run(target, round(dt / _STEP), kp, kd, k, alpha, law == "LuGre")
    return q, v, torque


def masing_knots() -> tuple[tuple[float, float], ...]:
    """Twice the Maxwell-slip joint's virgin curve, in both directions: what Fd would be."""
    k, alpha = maxwell_elements(Fs, REACH)
    yields = np.sort(2.0 * alpha * Fs / k)
    torques = np.minimum(k * yields[:, None], 2.0 * alpha * Fs).sum(axis=1)
    return tuple((float(z), float(F)) for z, F in zip(yields, torques, strict=True))
