"""Level of the friction, and four laws that reach it with presliding.

LuGre: Canudas de Wit et al. 1995. Elasto-plastic: Dupont et al. 2002. Dahl 1968, its hysteresis
scaled by a Stribeck level. Maxwell-slip elements beside a smooth Stribeck curve: Iwan 1966.
"""

import math

import numpy as np
from numba import njit

from .joint import AMBIENT

CREEP = 2e-3  # rad/s, over which the smooth curve changes sign
TANH_FRACTION = 0.15  # of the level, carried by the smooth curve
ELEMENTS = 8  # Maxwell-slip elements that carry the rest


@njit(cache=True)
def level(joint, t, q, v, load, temperature, age):
    """Torque at which friction saturates while sliding, N m, before any lag."""
    slow = math.exp(-((abs(v) / joint.stribeck_velocity) ** joint.stribeck_shape))
    s = joint.coulomb + (joint.breakaway - joint.coulomb) * slow
    s += (joint.load + joint.load_slow * slow) * abs(load)
    if joint.dwell != 0.0:
        s += joint.dwell * (1.0 - math.exp(-age / joint.dwell_time))
    s *= 1.0 + joint.level * math.sin(joint.level_order * q + joint.level_phase)
    s *= math.exp(-joint.level_per_kelvin * (temperature - AMBIENT))
    s *= 1.0 + joint.warm_up * math.exp(-t / joint.warm_up_time)
    return s * (1.0 + joint.asymmetry * math.tanh(v / CREEP))


@njit(cache=True)
def viscosity(joint, t, v, temperature):
    """N m s/rad."""
    c = joint.viscous * math.exp(-joint.viscous_per_kelvin * (temperature - AMBIENT))
    c *= 1.0 + joint.warm_up * math.exp(-t / joint.warm_up_time)
    return c * (1.0 + joint.asymmetry_viscous * math.tanh(v / CREEP))


@njit(cache=True)
def slipping_fraction(z, v, breakaway, steady):
    """Of the elasto-plastic law: 0 elastic, 1 sliding, a half sine between."""
    if z * v < 0.0 or abs(z) <= breakaway:
        return 0.0
    if abs(z) >= steady:
        return 1.0
    middle = 0.5 * (steady + breakaway)
    return 0.5 + 0.5 * math.sin(math.pi * (abs(z) - middle) / (steady - breakaway))


@njit(cache=True)
def bristle(joint, s, v, z):
    """Torque without viscosity and rate of the deflection z (rad), for the laws that have one."""
    k = joint.stiffness
    if joint.law == 2:
        u = z * k / joint.coulomb
        left = 1.0 - (u if v > 0.0 else -u)
        rate = v * math.copysign(abs(left) ** joint.shape, left)
        return s * u, rate
    steady = s / k
    slipping = 1.0
    if joint.law == 1:
        slipping = slipping_fraction(z, v, joint.shape * steady, steady)
    rate = v - slipping * abs(v) * z / steady
    fades = math.exp(-((v / joint.stribeck_velocity) ** 2))
    return k * z + joint.damping * fades * rate, rate


@njit(cache=True)
def element(held, stiffness, moved, limit):
    """Torque of a spring that slips at `limit`: exact while the motion keeps its direction."""
    return min(max(held + stiffness * moved, -limit), limit)


@njit(cache=True)
def parallel(elements, held, s, v, moved):
    """Torque of slipping springs, `elements` their (stiffness, fraction of s), and tanh curve."""
    total = TANH_FRACTION * s * math.tanh(v / CREEP)
    for i in range(elements.shape[0]):
        total += element(held[i], elements[i, 0], moved, elements[i, 1] * s)
    return total


def slip_elements(coulomb: float, stiffness: float) -> np.ndarray:
    """Stiffness and fraction of the level, shape (ELEMENTS, 2), with this initial stiffness."""
    reach = np.linspace(0.25, 1.75, ELEMENTS)  # where an element slips, evenly spread
    fraction = np.full(ELEMENTS, (1.0 - TANH_FRACTION) / ELEMENTS)
    k = fraction / reach
    return np.c_[k / k.sum() * stiffness, fraction]
