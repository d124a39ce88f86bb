"""Candidates for the residual, columns of effects of one or all joints, and their Gram matrices.

Effects common to all joints have one cause: a temperature, a supply. In each joint such an effect
has the same coefficients relative to that joint's friction level and viscosity, so a change too
small to detect in one joint can be detected in all together.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.diagnose.candidate import columns_of as term_columns
from frictionjoint.diagnose.candidate import signals_of
from frictionjoint.diagnose.library import effects, testable
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import Columns, JointGram, joint_gram


@dataclass(frozen=True)
class Candidate:
    """A shared cause, or an effect of one joint or of all, that may explain the residual.

    Attributes:
        cause: None for an effect. effect: its name. common: whether equal in all joints.
        at: its columns of the stack, from `first` on. joints: where it acts.
        room: by how much each number may change in either direction, shape (k, 2); for an effect of
            one joint, which that joint's search keeps within bounds, shape (0, 2).
    """

    at: Columns = field(repr=False)
    joints: tuple[str, ...]
    cause: Cause | None = None
    effect: str = ""
    common: EffectTerm | None = None
    first: int = 0
    room: Array = field(default_factory=lambda: np.zeros((0, 2)), repr=False)

    @property
    def shared(self) -> bool:
        """Whether the candidate is a cause of the robot, not of one joint."""
        return self.cause is not None or self.common is not None

    @property
    def essential(self) -> int:
        """Number of leading parameters without which the candidate does not exist."""
        return self.cause.essential if self.cause else len(self.at)

    @property
    def among(self) -> float:
        """Number of spectral lines of which it is the strongest."""
        return self.cause.among if self.cause else 1.0

    @property
    def changed(self) -> str:
        """Key that is common to all forms of one change."""
        return self.cause.changed if self.cause else self.label

    @property
    def label(self) -> str:
        return self.cause.label if self.cause else effect_label(self.effect, *self.joints)


def effect_label(effect: str, *joints: str) -> str:
    """Name of an effect and of the joints where it acts."""
    return f"{effect} of {', '.join(joints)}"


def columns_of(candidates: Iterable[Candidate]) -> Columns:
    """Columns of the stack of several candidates, in order."""
    return np.concatenate([*(c.at for c in candidates), []]).astype(np.int64)


def own_effects(joint: FittedJoint, clock: Clock, own: Callable[[str], bool]) -> dict[str, Array]:
    """Columns of the joint's effects that explain something, by name; `own`: labels wanted."""
    wanted = {e.name for e in CATALOGUE if own(effect_label(e.name, joint.name))}
    if not wanted:
        return {}
    law, e = law_columns(joint), joint.residual * joint.fit.weight
    base = orthonormal(law / lengths(law))
    # an effect that explains less than 2% of the joint's squares does not compete
    most = dict.fromkeys(wanted, 0.02 * float(e @ e))
    columns: dict[str, Array] = {}
    fitted = joint.prepared, joint.fit, clock.blocks(joint)
    for candidate in effects(*fitted, lambda effect: effect.name in wanted and not effect.delays):
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
    block, law = clock.of_sample(joint), law_columns(joint) / joint.left
    grams = joint_gram(law, columns * unit, joint.residual * unit[:, 0], block, clock.count)
    friction = root_mean_square(fitted.friction * fitted.weight)
    squares: Array = joint.unreached / joint.left**2
    beyond = np.bincount(block, squares, clock.count).astype(float)
    return JointGram(joint.name, len(fitted.residual), grams, at, joint.left, friction, beyond)


@dataclass(frozen=True)
class Common:
    """One effect of all joints: coefficients relative to each one's level or viscosity."""

    term: EffectTerm
    joints: tuple[str, ...]
    coefficients: Array
    covariance: Array

    @property
    def parameters(self) -> dict[str, Estimate]:
        """Coefficients with their standard errors, and the shape numbers."""
        effect, errors = self.term.effect, np.sqrt(np.diag(self.covariance))
        found = {
            name: Estimate(float(x), float(s) if np.isfinite(s) else None, "1")
            for name, x, s in zip(effect.coefficients, self.coefficients, errors, strict=True)
        }
        shape = zip(effect.shape, self.term.shape, effect.shape_units, strict=True)
        return found | {name: Estimate(x, None, unit) for name, x, unit in shape}


def common_terms(joints: Sequence[FittedJoint]) -> list[EffectTerm]:
    """Effects on the grid that the logs of all joints can test."""
    if len(joints) < 2:
        return []
    signals = [np.concatenate(signals_of(j.prepared, j.fit)) for j in joints]
    found = []
    # one cause for all joints: heat, or the scale of their torques
    for effect in (e for e in CATALOGUE if e.slow or e.scales):
        if not all(testable(j.prepared, effect, x) for j, x in zip(joints, signals, strict=True)):
            continue
        first, *others = (effect.shapes(x) for x in signals)
        # grids of two joints differ a little, because each joint's logs begin and end with its own
        # motion
        found += [
            EffectTerm(effect, shape)
            for shape in first
            if all(any(np.allclose(shape, s, rtol=0.1) for s in grid) for grid in others)
        ]
    return found


def common_columns(joint: FittedJoint, terms: Sequence[EffectTerm]) -> list[Array]:
    """Columns of each term per unit of its relative coefficients, each (n, k)."""
    signals = signals_of(joint.prepared, joint.fit)
    level, viscous = joint.levels
    own = {"T": level, "T s/x": viscous, "1": 1.0}
    return [
        term_columns(joint.prepared, signals, t) * [own[unit] for unit in t.effect.units]
        for t in terms
    ]
