"""The mean controller output around each sample of a log.

After the filter, only the mean output over half a sample on either side matters; a single tick
would be half a sample early and could represent delays of whole samples only. The mean is that of
the successive outputs, not the output at the mean error: after a jump of the command the output is
at its limit for part of a sample, and a fast joint is inside the dead band for part of a sample.
The output is constant until the next tick, so on average target and position were read half a tick
earlier.
"""

import math

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, in_line, pointer, room
from frictionjoint.control import kernel as k
from frictionjoint.control.profile import area_until, fill_path, last_before

# s: a sample is divided into quarters, but into parts of at least this length; within a part the
# output is computed from the mean error
_PART_S = 2.5e-3


@compiled
def fill_mean_drives(
    blocks: Array,
    delays: Vector,
    edges: Index,
    time: Array,
    target: Array,
    position: Array,
    velocity: Array,
    supply: Array,
    on: NDArray[np.bool_],
    path: Array,
    drive: Array,
) -> None:
    """Fill `drive` log by log.

    Args:
        blocks: of each log's controller, shape (k, BLOCK). delays: s, of the targets, shape (k,).
        edges: places where logs begin and end, shape (k + 1,). path: room for `fill_path`, shape
            (4, twice the samples of the longest log). The rest: see `Commands`.
    """
    S, tried, block = room(k.STATE), room(k.STATE), room(k.BLOCK)
    times = pointer(path, 0)
    for i in range(len(blocks)):
        first, last = edges[i], edges[i + 1] - 1
        for j in range(k.BLOCK):
            block[j] = blocks[i, j]
        count, rate = block[k.COUNT], block[k.SLEW]
        log, asked = pointer(time, first), pointer(target, first)
        corners = fill_path(log, asked, last + 1 - first, rate, path)
        # the target has been followed already; positions between samples are not quantised again
        block[k.SLEW], block[k.COUNT] = np.inf, 0.0
        old = 0.5 * block[k.PERIOD]
        for j in range(k.STATE):
            S[j] = 0.0
        at = 0
        for j in range(first, last + 1):
            before, after = max(j - 1, first), min(j + 1, last)
            width = (time[after] - time[before]) / (after - before)
            slope = (position[after] - position[before]) / (time[after] - time[before])
            read = position[j]
            if count > 0.0:
                read = count * math.floor(read / count + 0.5)
            read -= old * slope
            begin = time[j] - delays[i] - old - 0.5 * width
            end = begin + width
            at = last_before(times, corners, begin, at)
            c, since, until = at, begin, begin
            area = whole = area_until(path, c, begin)
            total = 0.0
            while until < end:
                until = _next(times, corners, c, since, end, max(width / 4, _PART_S))
                reached = area_until(path, c, until)
                passed = until - since
                if passed > 0.0:
                    q = read + slope * (0.5 * (since + until) - 0.5 * (begin + end))
                    goal = (reached - area) / passed
                    for s in range(k.STATE):
                        tried[s] = S[s]
                    total += passed * k.tick(block, tried, time[j], goal, q, velocity[j], supply[j])
                c, since, area = last_before(times, corners, until, c), until, reached
            goal = (area - whole) / width
            k.tick(block, S, time[j], goal, read, velocity[j], supply[j])
            drive[j] = total / width if on[j] else 0.0


@in_line
def _next(at: Vector, n: int, c: int, since: float, end: float, longest: float) -> float:
    """End of the part of an interval that begins at `since`, after corner c."""
    until = end if end - since < 1.5 * longest else since + longest
    return min(until, at[c + 1]) if c + 1 < n else until
