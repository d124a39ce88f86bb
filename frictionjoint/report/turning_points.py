"""Samples after turning points, where logs show presliding."""

from itertools import pairwise

import numpy as np

from frictionjoint.report.entries import Curve


def turns(c: Curve, size: float) -> list[slice]:
    """Samples from each turning point until the joint has moved by `size`, or turned again."""
    step = np.diff(c.position)
    moving = np.flatnonzero(step != 0.0)
    # a gap in the samples is no turn
    even = np.diff(c.time) < 1.5 * np.median(np.diff(c.time))
    found = []
    for a, b in pairwise(moving):
        if step[a] * step[b] >= 0.0 or not even[a : b + 1].all():
            continue
        end = b + 1
        while end < len(step) and even[end] and step[end] * step[b] > 0.0:
            end += 1
            # a window needs ten samples
            enough = end - b >= 10
            if enough and abs(c.position[end] - c.position[b]) >= size:
                found.append(slice(int(b), int(end) + 1))
                break
    return found
