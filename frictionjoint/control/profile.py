"""A command between the samples of a log: held, or followed with limited speed.

A log has one command per sample, and a controller follows it at a higher rate. A target that is
moved once per sample is up to one sample early.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, in_line

# rows of what `fill_path` fills
AT, PLACE, SLOPE, AREA = range(4)


def held(time: Array, x: Array, at: Array) -> Array:
    """Value of a command at other times, if each value is held until the next one."""
    index = np.searchsorted(time, at + 1e-9, side="right") - 1
    return np.asarray(x[np.clip(index, 0, len(x) - 1)])


def held_over(time: Array, command: Array, begin: Array, length: float) -> Array:
    """Mean over intervals, s, of a command that is held between samples, shape of `begin`.

    The mean is a smooth function of `begin`, and so of a delay below one sample.
    """
    area = np.append(0.0, np.cumsum(np.diff(time) * command[:-1]))
    first = area[1] / (time[1] - time[0])

    def until(t: Array) -> Array:
        outside = np.minimum(t - time[0], 0.0) * first + np.maximum(t - time[-1], 0.0) * command[-1]
        return np.asarray(np.interp(t, time, area) + outside)

    return (until(begin + length) - until(begin)) / length


def followed(time: Array, command: Array, at: Array, rate: float) -> Array:
    """Position at other times of a target that moves to each command at up to `rate`, rad/s (m/s);
    inf gives `held`."""
    if math.isinf(rate):
        return held(time, command, at)
    path = np.empty((2, 2 * len(time)))
    fill_corners(time, command, len(time), max(rate, 1e-9), path)
    return np.asarray(np.interp(at, path[AT], path[PLACE]))


@in_line
def fill_path(time: Vector, command: Vector, n: int, rate: float, path: Array) -> int:
    """Fill the rows of `path`, shape (4, at least 2 n), with the corners of a target.

    Rows: times, positions, speeds after each corner, and the area before it. Returns their number.
    """
    count = n
    ramps = rate != math.inf
    if ramps:
        count = 2 * n
        fill_corners(time, command, n, max(rate, 1e-9), path)
    else:
        for i in range(n):
            path[AT, i] = time[i]
            path[PLACE, i] = command[i]
    path[AREA, 0] = 0.0
    for i in range(count):
        path[SLOPE, i] = 0.0
    for i in range(count - 1):
        step = path[AT, i + 1] - path[AT, i]
        x, after = path[PLACE, i], path[PLACE, i + 1]
        if ramps:
            path[AREA, i + 1] = path[AREA, i] + 0.5 * step * (after + x)
            path[SLOPE, i] = (after - x) / step if step > 0.0 else 0.0
        else:
            path[AREA, i + 1] = path[AREA, i] + step * x
            # slope of the rounded area, so that it is continuous at the corners
            path[PLACE, i] = (path[AREA, i + 1] - path[AREA, i]) / step
    return count


@in_line
def area_until(path: Array, i: int, t: float) -> float:
    """Area under a speed-limited target up to a time after corner i, or before the first corner."""
    s = t - path[AT, i]
    until: float = path[AREA, i] + s * (path[PLACE, i] + 0.5 * max(s, 0.0) * path[SLOPE, i])
    return until


@in_line
def last_before(at: Vector, n: int, t: float, near: int) -> int:
    """Index of the last of n increasing times that is not after t, or 0; sought from `near` on."""
    while near + 1 < n and at[near + 1] <= t:
        near += 1
    while near > 0 and at[near] > t:
        near -= 1
    return near


@compiled
def fill_corners(time: Vector, command: Vector, n: int, rate: float, path: Array) -> None:
    """Fill the rows AT and PLACE of `path`, shape (2, 2 n) at least, with a target's corners."""
    here = command[0]
    for k in range(n):
        path[AT, 2 * k], path[PLACE, 2 * k] = time[k], here
        way = command[k] - here
        takes = abs(way) / rate
        if k + 1 < n and takes > time[k + 1] - time[k]:
            takes = time[k + 1] - time[k]
            way = math.copysign(rate * takes, way)
        here += way
        path[AT, 2 * k + 1], path[PLACE, 2 * k + 1] = time[k] + takes, here
