"""What friction may be like before any law is fitted: for what is asked of a log at once."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.segment import Segment
from frictionjoint.identify.smooth import elastic_plastic

# speed over the top speed below which friction is changing its side
_TURNS = 0.02
# displacements over the travel at which the elastic-plastic elements of friction slip
_REACHES = np.array([1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0])


def top_speed(segments: Sequence[Segment]) -> float:
    """Of all logs, rad/s (m/s), without the fastest hundredth of each; 1 where nothing moves."""
    return float(np.max([np.quantile(np.abs(s.signals[:, V]), 0.99) for s in segments])) or 1.0


def plain_friction(s: Segment, top: float) -> Array:
    """A side that friction changes with the motion, and elastic-plastic elements, shape (n, 7).

    Args:
        top: speed, rad/s (m/s).
    """
    q, v = s.signals[:, Q], s.signals[:, V]
    side = np.clip(v / (_TURNS * top), -1.0, 1.0)
    reaches = _REACHES * (float(np.ptp(q)) or 1.0)
    return np.column_stack([side, elastic_plastic(np.ascontiguousarray(q), reaches)])
