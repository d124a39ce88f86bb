"""The mean drive that a controller makes around each sample of a log.

A drive behind a filter has no more than its mean over half a sample on either side: a single tick
is half a sample early, and knows no delay but of whole samples. It is the mean of what the
controller puts out in turn and not what it would put out at the mean error: a command that leaps
holds it at its limit for a part of a sample, and a fast joint is within its dead band for a part.
What it puts out it holds until its next tick: on average it has read target and position half a
tick before.
"""

import math

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.control import kernel as k
from frictionjoint.control.profile import area_until, areas, last_before

# parts of a sample in each of which a drive is that of the mean error
_PARTS = 4


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
    drive: Array,
) -> None:
    """Fill `drive` log by log.

    Args:
        blocks: of each log's controller, shape (k, BLOCK). delays: s, of the targets, shape (k,).
        edges: places where logs begin and end, shape (k + 1,). The rest: see `Commands`.
    """
    for i in range(len(blocks)):
        first, last = edges[i], edges[i + 1] - 1
        block, count = blocks[i].copy(), blocks[i, k.COUNT]
        path = areas(time[first : last + 1], target[first : last + 1], block[k.SLEW])
        corners = path[0]
        # the target is followed already, and a position between two samples is not counted again
        block[k.SLEW], block[k.COUNT] = np.inf, 0.0
        old = 0.5 * block[k.PERIOD]
        S, tried = np.zeros(k.STATE), np.zeros(k.STATE)
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
            at = last_before(corners, begin, at)
            c, since, until = at, begin, begin
            area = whole = area_until(path, c, begin)
            total = 0.0
            while until < end:
                until = _next(corners, c, since, end, width / _PARTS)
                reached = area_until(path, c, until)
                passed = until - since
                if passed > 0.0:
                    q = read + slope * (0.5 * (since + until) - 0.5 * (begin + end))
                    goal = (reached - area) / passed
                    tried[:] = S
                    total += passed * k.tick(block, tried, time[j], goal, q, velocity[j], supply[j])
                c, since, area = last_before(corners, until, c), until, reached
            goal = (area - whole) / width
            k.tick(block, S, time[j], goal, read, velocity[j], supply[j])
            drive[j] = total / width if on[j] else 0.0


@in_line
def _next(corners: Vector, c: int, since: float, end: float, longest: float) -> float:
    """End of the part of a stretch that begins at `since`, after corner c."""
    until = end if end - since < 1.5 * longest else since + longest
    return min(until, corners[c + 1]) if c + 1 < len(corners) else until
