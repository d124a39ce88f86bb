"""Columns of a joint's law and of its own effects, and their Gram matrices."""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.diagnose.library import effects
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.robot.candidate import effect_label
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import Columns, JointGram, joint_gram


def own_effects(joint: FittedJoint, clock: Clock, own: Callable[[str], bool]) -> dict[str, Array]:
    """Columns of each of the joint's own effects that explains some of its residual, by name; those
    whose label is not wanted (`own`) are left out."""
    wanted = {e.name for e in CATALOGUE if own(effect_label(e.name, joint.name))}
    if not wanted:
        return {}
    law, e = law_columns(joint), joint.residual * joint.fit.weight
    base = orthonormal(law / lengths(law))
    # an effect that explains less than 2% of the joint's squares does not compete
    most = dict.fromkeys(wanted, 0.02 * float(e @ e))
    columns: dict[str, Array] = {}
    for candidate in effects(
        joint.prepared,
        joint.fit,
        clock.blocks(joint),
        lambda effect: effect.name in wanted and not effect.delays,
    ):
        name = candidate.term.name
        x = candidate.columns * joint.fit.weight[:, None]
        x = x - base @ (base.T @ x)
        explained = float(e @ x @ np.linalg.lstsq(x, e, rcond=1e-6)[0])
        if explained > most[name]:
            most[name], columns[name] = explained, candidate.columns
    return columns


def law_columns(joint: FittedJoint) -> Array:
    """Weighted columns of the joint's own law, shape (n, p)."""
    fitted = joint.fit
    return np.asarray(fitted.jacobian[:, fitted.open] * fitted.weight[:, None])


def gram_of(joint: FittedJoint, columns: Array, at: Columns, clock: Clock) -> JointGram:
    """Gram matrices of a joint's columns, shape (n, c), in units of its residual; `at` are their
    indices in the stack."""
    fitted = joint.fit
    unit = (fitted.weight / joint.left)[:, None]
    grams = joint_gram(
        law_columns(joint) / joint.left,
        columns * unit,
        joint.residual * unit[:, 0],
        clock.of_sample(joint),
        clock.count,
    )
    friction = root_mean_square(fitted.friction * fitted.weight)
    squares: Array = joint.unreached / joint.left**2
    beyond = np.bincount(clock.of_sample(joint), squares, clock.count).astype(float)
    return JointGram(joint.name, len(fitted.residual), grams, at, joint.left, friction, beyond)
