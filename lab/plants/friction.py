"""Friction laws of the plants, advanced by one fine step, each from its paper.

* generalised Maxwell-slip: Al-Bender, Lampaert, Swevers 2005, IEEE TAC 50(11), eqs. 9 to 12
* LuGre: Canudas de Wit, Olsson, Astrom, Lischinsky 1995, IEEE TAC 40(3), eqs. 1 to 3
* elasto-plastic: Dupont, Hayward, Armstrong, Altpeter 2002, IEEE TAC 47(5), eqs. 6 to 9
* plain: the Stribeck level handed to MuJoCo's own `frictionloss` constraint
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

ELEMENTS = 12
# GMS constant C in Fs per second. It makes sliding follow S(v) within a millisecond: a slower one
# is a frictional lag, which a plant has only where that effect is drawn.
ATTRACTION = 1000.0


@njit(cache=True)
def stribeck(v: float, fs: float, fc: float, vs: float, delta: float) -> float:
    """Level of the sliding friction at speed v, N m, positive."""
    return fc + (fs - fc) * math.exp(-((abs(v) / vs) ** delta))


@njit(cache=True)
def gms(z, slip, dx, v, h, level, k, alpha, attraction, sigma1, last):  # type: ignore[no-untyped-def]
    """Advance the elements' forces z by displacement dx; returns their sum, N m.

    A slipping element relaxes to its share of the level with an implicit step, and sticks again
    when the velocity changes sign. Sticking elements carry the micro-damping sigma1.
    """
    if v * last < 0.0:
        slip[:] = False
    s = 1.0 if v > 0.0 else -1.0
    total, sticking = 0.0, 0.0
    for i in range(z.size):
        if not slip[i]:
            z[i] += k[i] * dx
            sticking += alpha[i]
            if abs(z[i]) >= alpha[i] * level and z[i] * v > 0.0:
                slip[i] = True
        elif v != 0.0:
            z[i] = (z[i] + s * h * attraction * alpha[i]) / (1.0 + h * attraction / level)
        total += z[i]
    return total + sigma1 * sticking * v


@njit(cache=True)
def bristle(z, dx, h, level, sigma0, sigma1, plateau):  # type: ignore[no-untyped-def]
    """One bristle: LuGre for plateau = 0, elasto-plastic for 0 < plateau < 1; returns N m.

    Implicit in z, so bounded at any step. `plateau` is the part of the breakaway deflection
    within which the bristle is purely elastic.
    """
    old = z[0]
    steady = level / sigma0
    a = 1.0
    if plateau > 0.0:
        low = plateau * steady
        if old * dx <= 0.0 or abs(old) <= low:
            a = 0.0
        elif abs(old) < steady:
            a = 0.5 * (1.0 + math.sin(math.pi * (abs(old) - 0.5 * (steady + low)) / (steady - low)))
    z[0] = (old + dx) / (1.0 + a * abs(dx) / steady)
    return sigma0 * z[0] + sigma1 * (z[0] - old) / h


def maxwell_elements(fs: float, presliding: float) -> tuple[NDArray, NDArray]:
    """Stiffness (N m/rad) and share (sum 1) of the Maxwell-slip elements.

    Breakaway displacements are spread geometrically up to `presliding`; shares are equal, so the
    virgin curve is steep at first and rounds off towards Fs.
    """
    reach = presliding * np.geomspace(0.08, 1.0, ELEMENTS)
    alpha = np.full(ELEMENTS, 1.0 / ELEMENTS)
    return alpha * fs / reach, alpha
