"""Comparison of the residual sums of squares of two models: more, fewer, or indistinguishable.

Sums of squares are by joint and block of time, shape (J, B), in units of each joint's residual.
"""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY, LEAST_MOVED, SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.robot.stack import Stack


def improves(stack: Stack, before: Array, after: Array) -> bool:
    """Whether the reduction is larger than chance and the laws' own errors could produce."""
    large = joint_gain(before, after) >= SMALLEST_GAIN
    return large and _moved(stack, before, after) >= LEAST_MOVED and better(after, before)


def harms(after: Array, before: Array) -> bool:
    """Whether a joint is predicted noticeably worse, and by more than chance."""
    return any(
        float(a.sum()) > (1.0 + CLEARLY) * float(b.sum()) and better(b[None], a[None])
        for a, b in zip(after, before, strict=True)
    )


def gain_of(before: Array, after: Array) -> float:
    """Largest fraction of a joint's sum of squares that a candidate removes."""
    return float((1.0 - left_of(before, after)).max())


def joint_gain(before: Array, after: Array) -> float:
    """Gain over all joints: one minus the product of the ratios of their sums of squares. Laws err
    independently, and one cause seldom resembles all their errors."""
    return 1.0 - float(np.prod(left_of(before, after)))


def left_of(before: Array, after: Array) -> Array:
    """Ratio of the sums of squares after and before, by joint, shape (J,)."""
    return np.asarray(after.sum(axis=1) / np.maximum(before.sum(axis=1), 1e-300))


def as_good(stack: Stack, after: Array, before: Array) -> bool:
    """Whether a model is not clearly worse than another, for no joint by a noticeable part; below
    the laws' own errors, one explanation is no better than another."""
    if _moved(stack, after, before) < LEAST_MOVED:
        return True
    least = float(after.sum()) <= (1.0 + CLEARLY) * float(before.sum())
    return least and not better(before, after) and not harms(after, before)


def nearer(deviation: float, other: float) -> bool:
    """Whether bodies are clearly nearer to nominal, by squared numbers over prior variances."""
    # the presumption makes the other one's deviation less than 5% as likely
    return deviation < other + 2.0 * float(np.log(SIGNIFICANCE))


def _moved(stack: Stack, before: Array, after: Array) -> float:
    """Largest rms of the torque by which a joint improves, relative to its friction."""
    found = []
    for k, joint in enumerate(stack.joints):
        less = max(0.0, float(before[k].sum() - after[k].sum())) / joint.samples
        found.append(np.sqrt(less) * joint.left / joint.friction if joint.friction else 0.0)
    return float(max(found))


def better(one: Array, other: Array) -> bool:
    """Whether the sum of squares falls by more than a paired standard error over blocks."""
    difference = (other - one).sum(axis=0)
    return bool(difference.sum() > float(np.std(difference)) * np.sqrt(len(difference)))
