"""Screening of shared causes and of each joint's own effects against all joints' residuals."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.layout import term_bounds
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.causes.cause import Cause, Found
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import Candidate, columns_of, common_columns, gram_of, own_effects
from frictionjoint.robot.fit_causes import fitted_causes
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import Columns, Stack


@dataclass(frozen=True)
class Screened:
    """The stack, and what its columns are: `accepted` causes in the model, and `candidates`."""

    stack: Stack
    accepted: tuple[Candidate, ...]
    candidates: tuple[Candidate, ...]

    def columns(self, more: Iterable[Candidate]) -> Columns:
        """Columns of the causes in the model and of more candidates, in order."""
        return columns_of((*self.accepted, *more))

    def held_out(self, more: Iterable[Candidate]) -> Array:
        """Sum of squares with the causes in the model and more candidates, (J, B), see `Stack`."""
        return self.stack.held_out(self.columns(more))

    def numbers(self, more: Sequence[Candidate]) -> list[Array]:
        """Numbers of each of some candidates, fitted together with the causes in the model."""
        known = columns_of(self.accepted)
        ends = np.cumsum([len(known), *(len(c.at) for c in more)])[:-1]
        return np.split(self.stack.solution(self.columns(more)), ends)[1:]

    def without(self, candidate: Candidate) -> "Screened":
        """The screened model without a cause, whichever of its numbers are free."""
        rest = tuple(c for c in self.candidates if c.first != candidate.first)
        return replace(self, candidates=rest)


def screen(
    joints: Sequence[FittedJoint],
    clock: Clock,
    found: Found,
    causes: Sequence[Cause],
    own: Callable[[str], bool] = lambda label: True,
    common: Sequence[EffectTerm] = (),
    shaped: Sequence[FittedJoint] = (),
) -> Screened:
    """Columns of all causes and of the joints' own effects.

    Args:
        found: causes in the model. causes: candidates.
        own: labels of the joints' own effects that compete. common: effects common to all joints.
        shaped: joints whose residuals determine the shapes of their own effects; none: `joints`.
    """
    n = len(found.causes)
    models = [found.with_cause(c, _start(joints, clock, found, c)) for c in causes]
    pairs = [*(found.pairs(i) for i in range(n)), *(m.pairs(n) for m in models)]
    edges = np.cumsum([0, *(len(p) for p in pairs)])
    size = int(edges[-1])
    effects: list[Candidate] = []
    names = tuple(j.name for j in joints)
    for term in common:
        of_term = size + np.arange(len(term.coefficients))
        room = np.array(term_bounds(joints[0].prepared, term))
        effects.append(Candidate(of_term, names, None, term.name, term, size, room))
        size += len(of_term)
    of_robot, grams = np.arange(size), []
    for joint, like in zip(joints, shaped or joints, strict=True):
        at = [of_robot]
        parts = [joint.columns(list(itertools.chain(*pairs))), *common_columns(joint, common)]
        for name, x in own_effects(like, clock, own).items():
            at.append(size + np.arange(x.shape[1]))
            parts.append(x)
            effects.append(Candidate(at[-1], (joint.name,), effect=name, first=size))
            size += x.shape[1]
        columns = np.column_stack(parts)
        norm = np.linalg.norm(columns, axis=0)
        # smaller columns are rounding of a difference
        acts = norm > 1e-8 * norm.max(initial=0.0)
        grams.append(gram_of(joint, columns[:, acts], np.concatenate(at)[acts], clock))
    numbers = [*found.numbers, *(c.start for c in causes)]
    precision, pull = np.zeros(size), np.zeros(size)
    sets = []
    for k, (cause, x) in enumerate(zip((*found.causes, *causes), numbers, strict=True)):
        own_at = np.arange(edges[k], edges[k + 1])
        precision[own_at] = clock.alike * cause.prior**-2.0
        pull[own_at] = -precision[own_at] * x
        moved = tuple(g.name for g in grams if np.isin(own_at, g.columns).any())
        room = np.array(cause.bounds) - x[:, None]
        sets.append(Candidate(own_at, moved, cause, first=int(edges[k]), room=room))
    candidates = [c for c in sets[n:] if c.joints]
    stack = Stack(grams, clock, precision, pull)
    return Screened(stack, tuple(sets[:n]), (*candidates, *effects))


def _start(joints: Sequence[FittedJoint], clock: Clock, found: Found, cause: Cause) -> Array:
    """Numbers at which a cause's columns are computed: no cause, or a better start of a homogeneous
    one, whose columns are exact along a ray from zero."""
    if not cause.homogeneous:
        return cause.start
    start = found.with_cause(cause, cause.start)
    return fitted_causes(joints, clock, start, lambda label: False).numbers[-1]
