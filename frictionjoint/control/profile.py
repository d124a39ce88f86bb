"""A command as a controller follows it between the samples of a log: held, or at a limited speed.

A log knows its command once a sample, and a controller follows it many times as often. A target
that is moved once a sample is where it ought to be at the end of it, up to a sample early.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, in_line


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
    return followed_over(time, command, begin, length, math.inf)


def followed_over(
    time: Array, command: Array, begin: Array, length: Array | float, rate: float
) -> Array:
    """The same of a target that moves to each command at no more than a speed.

    Args:
        rate: of the target, rad/s (m/s); inf: `held_over`.
    """
    lengths, out = np.full_like(begin, length), np.empty_like(begin)
    fill_means(time, command, begin, lengths, rate, out)
    return out


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
def fill_means(
    time: Array, command: Array, begin: Vector, length: Vector, rate: float, out: Vector
) -> None:
    """Fill `out`, see `followed_over`; fastest where stretches come in turn."""
    path = areas(time, command, rate)
    first, last = 0, 0
    for k in range(len(begin)):
        end = begin[k] + length[k]
        first, last = last_before(path[0], begin[k], first), last_before(path[0], end, last)
        out[k] = area_until(path, last, end)
        out[k] = (out[k] - area_until(path, first, begin[k])) / length[k]


@in_line
def areas(time: Array, command: Array, rate: float) -> tuple[Array, Array, Array, Array]:
    """Corners of a target, where it is from each on, how fast it moves, and the area before it."""
    at, x, ramps = time, command.copy(), not math.isinf(rate)
    if ramps:
        at, x = np.empty(2 * len(time)), np.empty(2 * len(time))
        _fill_corners(time, command, max(rate, 1e-9), at, x)
    slope, area = np.zeros(len(at)), np.zeros(len(at))
    for i in range(len(at) - 1):
        step = at[i + 1] - at[i]
        if ramps:
            area[i + 1] = area[i] + 0.5 * step * (x[i + 1] + x[i])
            slope[i] = (x[i + 1] - x[i]) / step if step > 0.0 else 0.0
        else:
            area[i + 1] = area[i] + step * x[i]
            # the slope of the area as it was rounded: it goes on evenly at the corners
            x[i] = (area[i + 1] - area[i]) / step
    return at, x, slope, area


@in_line
def area_until(path: tuple[Array, Array, Array, Array], i: int, t: float) -> float:
    """Area under such a target up to a time after its corner i, or before the first one."""
    at, x, slope, area = path
    s = t - at[i]
    until: float = area[i] + s * (x[i] + 0.5 * max(s, 0.0) * slope[i])
    return until


@in_line
def last_before(at: Vector, t: float, near: int) -> int:
    """Place of the last of some increasing times that is not after t, or of the first one.

    Args:
        near: where the search begins.
    """
    while near + 1 < len(at) and at[near + 1] <= t:
        near += 1
    while near > 0 and at[near] > t:
        near -= 1
    return near


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
