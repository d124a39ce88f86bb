"""Where logs show presliding: the samples behind turning points, and how far presliding reaches."""

from itertools import pairwise

import numpy as np

from frictionjoint.diagnose.report_data import Curve
from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction

# samples that a window needs
_LEAST_SAMPLES = 10
_SLOW = 1e-6


def length(law: Friction) -> float:
    """Displacement, rad, behind a turn until friction has made nine tenths of its change."""
    x = np.geomspace(1e-9, 1.0, 2000)
    q = np.concatenate([[0.0], x, x[-1] - x])
    F = friction_torque(law, np.arange(len(q)) / _SLOW, q)
    back = F[len(x) + 1 :]
    return float(x[np.argmax(back <= F[len(x)] + 0.9 * (back[-1] - F[len(x)]))])


def turns(c: Curve, size: float) -> list[slice]:
    """Samples from each turning point on until the joint has gone `size`, or turned again."""
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
            enough = end - b >= _LEAST_SAMPLES
            if enough and abs(c.position[end] - c.position[b]) >= size:
                found.append(slice(int(b), int(end) + 1))
                break
    return found
