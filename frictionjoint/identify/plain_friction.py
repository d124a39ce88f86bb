"""Rough friction regressors, used before a law is fitted."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.segment import Segment
from frictionjoint.identify.smooth import elastic_plastic

# displacements over the travel at which the elastic-plastic elements of friction slip
_REACHES = np.array([1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0])


def top_speed(segments: Sequence[Segment]) -> float:
    """Top speed of all logs without the fastest 1% of samples of each, rad/s (m/s); 1 if nothing
    moves."""
    return float(np.max([np.quantile(np.abs(s.signals[:, V]), 0.99) for s in segments])) or 1.0


def plain_friction(s: Segment, top: float) -> Array:
    """A smooth sign of the velocity, and elastic-plastic elements, shape (n, 7)."""
    q, v = s.signals[:, Q], s.signals[:, V]
    # below 2% of the top speed friction is changing its side
    side = np.clip(v / (0.02 * top), -1.0, 1.0)
    reaches = _REACHES * (float(np.ptp(q)) or 1.0)
    return np.column_stack([side, elastic_plastic(q, reaches)])
