"""Where the search for a law begins: what a linear fit shows of its levels and its presliding."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from frictionjoint.arrays import Array

# speeds over the top speed at which the level has fallen to 1/e of what it falls by. Sums of such
# falls, exp(-(v/s)**2), are all falls of a Stribeck exponent up to 2.
_FALLS = np.array([0.002, 0.006, 0.02, 0.06, 0.2])
# fractions of what a transition curve reaches at which its knots are taken. The last is less than
# all of it, which a sum of elements reaches with the softest of them.
_KNOTS = (0.5, 0.8, 0.98)
# speeds over the top speed at which the level is looked at, and where a Stribeck curve may be
_SPEEDS, _VELOCITIES = np.geomspace(1e-3, 0.5, 60), np.geomspace(2e-3, 0.25, 25)
_EXPONENTS = (0.6, 0.8, 1.0, 1.4, 2.0)
# least rise over the Coulomb level, of which Stribeck velocity and exponent may be searched
_LEAST_RISE = 0.02


@dataclass(frozen=True)
class LawStart:
    """What all laws have in common, as a search for one begins with it.

    Attributes:
        excess: Fs / Fc - 1. Vs: Stribeck velocity, rad/s (m/s). delta: its exponent.
        length: displacement from a reversal over which half of the friction turns round, rad (m).
        bend: slopes of the curve's second part over its first, and third over second.
    """

    excess: float
    Vs: float
    delta: float
    length: float
    bend: tuple[float, float]

    @classmethod
    def of(cls, reaches: Array, levels: Array, top_speed: float) -> Self:
        """Start of a search from the linear fit of elastic-plastic elements in parallel.

        Args:
            reaches: displacement from rest to slipping of each element, rad (m), shape (k,).
            levels: of each element, for each function in `falls`, shape (1 + f, k).
        """
        excess, Vs, delta = _stribeck(falls(_SPEEDS) @ levels.sum(axis=1))
        length, bend = _transition(reaches, levels.sum(axis=0))
        return cls(excess, Vs * top_speed, delta, length, bend)


def falls(speed: Array) -> Array:
    """What of a level is left at speeds over the top speed, shape (n, 1 + f): all, then less."""
    return np.column_stack([np.ones_like(speed), np.exp(-((speed[:, None] / _FALLS) ** 2))])


def _stribeck(level: Array) -> tuple[float, float, float]:
    """Fs / Fc - 1, Vs over the top speed, and delta of the nearest curve through a level."""
    best = (np.inf, _LEAST_RISE, 0.05, 1.0)
    for delta in _EXPONENTS:
        fall = np.exp(-((_SPEEDS / _VELOCITIES[:, None]) ** delta))
        deviation = fall - fall.mean(axis=1, keepdims=True)
        rise = deviation @ level / np.sum(deviation**2, axis=1)
        Fc = level.mean() - rise * fall.mean(axis=1)
        left = np.sum((level - Fc[:, None] - rise[:, None] * fall) ** 2, axis=1)
        left[(Fc <= 0.0) | (rise < 0.0)] = np.inf
        k = int(np.argmin(left))
        if left[k] < best[0]:
            best = left[k], max(float(rise[k] / Fc[k]), _LEAST_RISE), _VELOCITIES[k], delta
    return best[1], float(best[2]), best[3]


def _transition(reaches: Array, levels: Array) -> tuple[float, tuple[float, float]]:
    """First knot and bends of the curve after a reversal, where all displacements are double."""
    z = np.geomspace(0.05 * reaches[0], 2.0 * reaches[-1], 1000)
    curve = np.minimum(z[:, None] / reaches, 2.0) @ levels / (2.0 * float(levels.sum()) or 1.0)
    knots = np.interp(_KNOTS, curve, z)
    slopes = np.diff([0.0, *_KNOTS]) / np.maximum(np.diff([0.0, *knots]), np.finfo(float).tiny)
    first, second = slopes[1:] / slopes[:-1]
    return float(knots[0]), (float(first), float(second))
