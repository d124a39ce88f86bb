"""Starting values for a law from a linear fit: its levels and its presliding."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.rounding import EQUAL

# scales s of the functions exp(-(v/s)**2) by which the level decreases, as fractions of the top
# speed. Sums of these functions represent every Stribeck curve with an exponent up to 2.
_FALLS = np.array([0.002, 0.006, 0.02, 0.06, 0.2])
# fractions of the final torque of a transition curve at which its knots are placed. The last is
# below 1, because a sum of elements reaches 1 only when its softest element slips.
_KNOTS = (0.5, 0.8, 0.98)
# speeds at which the level is evaluated, and possible Stribeck velocities, over the top speed
_SPEEDS, _VELOCITIES = np.geomspace(1e-3, 0.5, 60), np.geomspace(2e-3, 0.25, 25)


@dataclass(frozen=True)
class LawStart:
    """Starting values that apply to every law."""

    excess: float  # Fs / Fc - 1
    Vs: float  # Stribeck velocity, rad/s (m/s)
    delta: float  # its exponent
    length: float  # displacement, rad (m), after a reversal for half of the friction change
    # slope of the curve's second segment over its first, and of its third over its second
    bend: tuple[float, float]

    @classmethod
    def of(cls, reaches: Array, levels: Array, top_speed: float) -> Self:
        """Start of a search from the linear fit of elastic-plastic elements, see `LinearLaw`."""
        excess, Vs, delta = _stribeck(falls(_SPEEDS) @ levels.sum(axis=1))
        length, bend = _transition(reaches, levels.sum(axis=0))
        return cls(excess, Vs * top_speed, delta, length, bend)


def with_excess(before: tuple[float, float, float], excess: float) -> tuple[float, float, float]:
    """A Stribeck curve (Fs / Fc - 1, Vs, delta) of another height that resembles one.

    A lower one has value and slope of the higher one where it has fallen to 1/e of its own height,
    so that they differ at lower speeds only.
    """
    height, Vs, delta = before
    steeper = 1.0 + np.log(height / excess) if 0.0 < excess < height else 1.0
    return excess, float(Vs * steeper ** (1.0 / delta)), float(delta * steeper)


def falls(speed: Array) -> Array:
    """Basis functions of the level over speed as a fraction of the top speed, shape (n,): a
    constant, then decreasing ones, shape (n, 1 + f)."""
    return np.column_stack([np.ones_like(speed), np.exp(-((speed[:, None] / _FALLS) ** 2))])


def _stribeck(level: Array) -> tuple[float, float, float]:
    """Fit of a Stribeck curve to a level: Fs / Fc - 1, Vs over the top speed, and delta."""
    # from the least Fs / Fc - 1 on, a search can adjust the Stribeck velocity and exponent
    least = 0.02
    # a level that does not fall shows no curve, and rounding must not choose one
    equal = len(level) * (EQUAL * level.mean()) ** 2
    flat = float(np.sum((level - level.mean()) ** 2))
    best = (max(flat, equal), least, 0.05, 1.0)
    for delta in (0.6, 0.8, 1.0, 1.4, 2.0):
        fall = np.exp(-((_SPEEDS / _VELOCITIES[:, None]) ** delta))
        deviation = fall - fall.mean(axis=1, keepdims=True)
        rise = deviation @ level / np.sum(deviation**2, axis=1)
        Fc = level.mean() - rise * fall.mean(axis=1)
        left = np.sum((level - Fc[:, None] - rise[:, None] * fall) ** 2, axis=1)
        left[(Fc <= 0.0) | (rise < 0.0)] = np.inf
        left = np.maximum(left, equal)
        k = int(np.argmin(left))
        if left[k] < best[0]:
            best = left[k], max(float(rise[k] / Fc[k]), least), _VELOCITIES[k], delta
    return best[1], float(best[2]), best[3]


def _transition(reaches: Array, levels: Array) -> tuple[float, tuple[float, float]]:
    """First knot and `bend` of the curve after a reversal, which doubles all displacements."""
    z = np.geomspace(0.05 * reaches[0], 2.0 * reaches[-1], 1000)
    curve = np.minimum(z[:, None] / reaches, 2.0) @ levels / (2.0 * float(levels.sum()) or 1.0)
    knots = np.interp(_KNOTS, curve, z)
    slopes = np.diff([0.0, *_KNOTS]) / np.maximum(np.diff([0.0, *knots]), np.finfo(float).tiny)
    first, second = slopes[1:] / slopes[:-1]
    return float(knots[0]), (float(first), float(second))
