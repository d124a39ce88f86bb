"""Friction of the joint: parameters common to the laws, and how they are drawn."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

LUGRE, MAXWELL, ELASTOPLASTIC, DAHL = range(4)
ELEMENTS = 8  # of Maxwell-slip; the other laws use the first entry of the state


class Friction(NamedTuple):
    """Stribeck level, presliding and viscous friction, SI units."""

    law: int
    coulomb: float  # level when sliding fast, N m
    static: float  # level at standstill, N m
    stribeck: float  # rad/s
    shape: float  # exponent of the Stribeck curve
    presliding: float  # displacement scale: static level over stiffness, rad
    damping: float  # of the presliding spring, N m s/rad
    damping_speed: float  # above which that damping fades, rad/s
    breakaway: float  # elasto-plastic: share of the level below which nothing is lost
    viscous: float  # N m at 1 rad/s
    power: float  # of the viscous friction; 1 is linear
    asymmetry: float  # levels are (1 + a) and (1 - a) times as high
    load: float  # rise of the level with the torque transmitted


@njit
def level(f: Friction, v: float, direction: float, transmitted: float) -> float:
    """Largest hysteresis torque at speed v in a direction (1 or -1), N m."""
    curve = f.coulomb
    if f.static > f.coulomb:
        curve += (f.static - f.coulomb) * math.exp(-((abs(v) / f.stribeck) ** f.shape))
    return curve * (1.0 + direction * f.asymmetry) + f.load * abs(transmitted)


@njit
def viscous_coefficient(f: Friction, v: float) -> float:
    """Viscous torque over speed, N m s/rad; concave laws are rounded below 0.02 rad/s."""
    if f.power == 1.0:
        return f.viscous
    return f.viscous * (v * v + 4e-4) ** (0.5 * (f.power - 1.0))


def draw_friction(
    rng: np.random.Generator, torque_range: float, speed: float, inertia: float
) -> Friction:
    """Friction of 5 to 25% of the torque range for motion up to `speed`, rad/s."""
    coulomb = torque_range * rng.uniform(0.05, 0.17)
    static = coulomb * (rng.uniform(1.05, 1.45) if rng.random() < 0.75 else 1.0)
    presliding = math.exp(rng.uniform(math.log(1e-4), math.log(5e-3)))
    critical = 2 * math.sqrt(static / presliding * inertia)
    power = rng.uniform(0.45, 0.8) if rng.random() < 0.35 else 1.0
    viscous = torque_range * rng.uniform(0.01, 0.07) / speed**power
    return Friction(
        law=int(rng.integers(4)),
        coulomb=float(coulomb),
        static=float(static),
        stribeck=float(math.exp(rng.uniform(math.log(0.02), math.log(0.3)))),
        shape=float(rng.choice((1.0, 2.0))),
        presliding=float(presliding),
        damping=float(critical * rng.uniform(0.05, 0.3)),
        damping_speed=float(rng.uniform(0.02, 0.1)),
        breakaway=float(rng.uniform(0.3, 0.8)),
        viscous=float(viscous),
        power=float(power),
        asymmetry=0.0,
        load=0.0,
    )
