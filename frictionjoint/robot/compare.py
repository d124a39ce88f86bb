"""Squares that two models leave of the joints, compared: more, fewer, or not to be told apart.

Squares are by joint and block of time, shape (J, B), in units of what each joint's fit leaves.
"""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.decisions import DISCREPANCY, SMALLEST_GAIN
from frictionjoint.robot.stack import Stack

# part of a joint's squares that a cause may add to them: a cause that is there harms no joint
HARM = 0.05

# squares over presumed variances: about as far as one number is presumed to be off
_NEARER = 1.0


def enough(stack: Stack, before: Array, after: Array) -> bool:
    """Whether more is taken away than the laws' own errors might feign."""
    return (
        joint_gain(before, after) >= SMALLEST_GAIN and _moved(stack, before, after) >= DISCREPANCY
    )


def harms(after: Array, before: Array) -> bool:
    """Whether a joint is predicted worse, by a noticeable part and more than chance."""
    return any(
        float(a.sum()) > (1.0 + HARM) * float(b.sum()) and better(b[None], a[None])
        for a, b in zip(after, before, strict=True)
    )


def gain_of(before: Array, after: Array) -> float:
    """Fraction of a joint's squares that a candidate takes away, where that is most."""
    return float((1.0 - left_of(before, after)).max())


def joint_gain(before: Array, after: Array) -> float:
    """Gain of all joints as if it were one's: what is left is the product of what each leaves.

    The laws of several joints err independently, and one cause seldom likens all their errors.
    """
    return 1.0 - float(np.prod(left_of(before, after)))


def left_of(before: Array, after: Array) -> Array:
    """Squares left over those before, by joint, shape (J,)."""
    return np.asarray(after.sum(axis=1) / np.maximum(before.sum(axis=1), 1e-300))


def as_much(stack: Stack, after: Array, before: Array) -> bool:
    """Whether squares are not clearly more than others, of no joint by a noticeable part.

    By what is less than the laws' own errors one explanation is no better than another.
    """
    if _moved(stack, after, before) < DISCREPANCY:
        return True
    least = float(after.sum()) <= (1.0 + HARM) * float(before.sum())
    return least and not better(before, after) and not harms(after, before)


def nearer(strayed: float, other: float) -> bool:
    """Whether bodies are noticeably nearer to the model's own figures than others.

    Args:
        strayed, other: squares of their numbers over the variances presumed of each.
    """
    return strayed < other - _NEARER


def _moved(stack: Stack, before: Array, after: Array) -> float:
    """rms of the torque by which a joint is nearer, over its friction's, of the joint where that
    is most.
    """
    found = []
    for k, joint in enumerate(stack.joints):
        less = max(0.0, float(before[k].sum() - after[k].sum())) / joint.samples
        found.append(np.sqrt(less) * joint.left / joint.friction if joint.friction else 0.0)
    return float(max(found))


def better(one: Array, other: Array) -> bool:
    """Whether squares are fewer by more than a paired standard error over blocks of time."""
    difference = (other - one).sum(axis=0)
    return bool(difference.sum() > float(np.std(difference)) * np.sqrt(len(difference)))
