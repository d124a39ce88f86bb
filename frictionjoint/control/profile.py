"""A command as a controller follows it between the samples of a log: held, or at a limited speed.

A log knows its command once a sample, and a controller follows it many times as often. A target
that is moved once a sample is where it ought to be at the end of it, up to a sample early.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled


def held(time: Array, x: Array, at: Array) -> Array:
    """A command at other times: each holds until the next one."""
    index = np.searchsorted(time, at + 1e-9, side="right") - 1
    return np.asarray(x[np.clip(index, 0, len(x) - 1)])


def held_over(time: Array, command: Array, begin: Array, length: Array | float) -> Array:
    """Mean of a command that holds until the next one, over stretches of time, shape of `begin`.

    It depends smoothly on when they begin, and so on a delay that is finer than a sample.

    Args:
        begin, length: of the stretches, s.
    """
    area = np.concatenate([[0.0], np.cumsum(np.diff(time) * command[:-1])])

    def until(t: Array) -> Array:
        before, after = np.minimum(t - time[0], 0.0), np.maximum(t - time[-1], 0.0)
        return np.asarray(np.interp(t, time, area) + before * command[0] + after * command[-1])

    return (until(begin + length) - until(begin)) / length


def followed_over(
    time: Array, command: Array, begin: Array, length: Array | float, rate: float
) -> Array:
    """The same of a target that moves to each command at no more than a speed.

    Args:
        rate: of the target, rad/s (m/s); inf: `held_over`.
    """
    if math.isinf(rate):
        return held_over(time, command, begin, length)
    at, x = _corners(time, command, rate)
    step = np.diff(at)
    slope = np.append(np.where(step > 0.0, np.diff(x) / np.maximum(step, 1e-300), 0.0), 0.0)
    area = np.concatenate([[0.0], np.cumsum(0.5 * step * (x[1:] + x[:-1]))])

    def until(t: Array) -> Array:
        i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, len(at) - 1)
        s = t - at[i]
        return np.asarray(area[i] + s * (x[i] + 0.5 * np.maximum(s, 0.0) * slope[i]))

    return (until(begin + length) - until(begin)) / length


def followed(time: Array, command: Array, at: Array, rate: float) -> Array:
    """Where such a target is at other times; inf: `held`."""
    if math.isinf(rate):
        return held(time, command, at)
    return np.interp(at, *_corners(time, command, rate))


def _corners(time: Array, command: Array, rate: float) -> tuple[Array, Array]:
    """Times and places between which such a target moves evenly, shape (2 n,) each."""
    at, x = np.empty(2 * len(time)), np.empty(2 * len(time))
    _fill_corners(time, command, max(rate, 1e-9), at, x)
    return at, x


@compiled
def _fill_corners(time: Vector, command: Vector, rate: float, at: Vector, x: Vector) -> None:
    """Fill `at` and `x`, see `_corners`."""
    here = command[0]
    for k in range(len(time)):
        at[2 * k], x[2 * k] = time[k], here
        way = command[k] - here
        takes = abs(way) / rate
        if k + 1 < len(time) and takes > time[k + 1] - time[k]:
            takes = time[k + 1] - time[k]
            way = math.copysign(rate * takes, way)
        here += way
        at[2 * k + 1], x[2 * k + 1] = time[k] + takes, here
