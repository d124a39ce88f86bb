"""Screening of every shared cause and every joint's own effects against the residuals of all
joints."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.layout import term_bounds
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.candidate import Candidate
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import gram_of, own_effects
from frictionjoint.robot.common import common_columns
from frictionjoint.robot.descend import descended
from frictionjoint.robot.found import Found
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import Stack


@dataclass(frozen=True)
class Screened:
    """The stack and the meaning of its columns.

    Attributes:
        accepted: columns of the causes in the model. candidates: columns of possible additions.
    """

    stack: Stack
    accepted: tuple[Candidate, ...]
    candidates: tuple[Candidate, ...]

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
    starts = [_start(joints, clock, found, c) for c in causes]
    models = [found.with_cause(c, x) for c, x in zip(causes, starts, strict=True)]
    pairs = [found.pairs(i) for i in range(len(found.causes))]
    pairs += [m.pairs(len(found.causes)) for m in models]
    edges = np.cumsum([0, *(len(p) for p in pairs)])
    shared = [np.arange(a, b) for a, b in itertools.pairwise(edges)]
    size = int(edges[-1])
    parts = []
    effects = _of_all(joints, common, size)
    size += sum(len(c.at) for c in effects)
    for joint, like in zip(joints, shaped or joints, strict=True):
        columns = joint.columns([pair for several in pairs for pair in several])
        columns = np.column_stack([columns, *common_columns(joint, common)])
        for candidate, x in own_effects(like, clock, own):
            at = size + np.arange(x.shape[1])
            effects.append(replace(candidate, at=at, first=int(at[0])))
            columns, size = _append(columns, x, size), size + x.shape[1]
        parts.append(columns)
    norms = [np.linalg.norm(x, axis=0) for x in parts]
    grams = []
    acts: dict[int, list[str]] = {}
    for joint, x, norm in zip(joints, parts, norms, strict=True):
        # smaller columns are rounding of a difference
        at = np.flatnonzero(norm > 1e-8 * norm.max(initial=0.0))
        for k in at:
            acts.setdefault(int(k), []).append(joint.name)
        grams.append(gram_of(joint, x, at, clock))
    numbers = [*found.numbers, *(c.start for c in causes)]
    precision, pull = np.zeros(size), np.zeros(size)
    for at, cause, x in zip(shared, (*found.causes, *causes), numbers, strict=True):
        precision[at] = clock.alike * cause.prior**-2.0
        pull[at] = -precision[at] * x
    stack = Stack(grams, clock, precision, pull)
    sets = []
    for at, cause, x in zip(shared, (*found.causes, *causes), numbers, strict=True):
        where = {name for k in at for name in acts.get(int(k), [])}
        named = tuple(j.name for j in joints if j.name in where)
        room = np.array(cause.bounds) - x[:, None]
        sets.append(Candidate(at, named, cause, first=int(at[0]), room=room))
    n = len(found.causes)
    candidates = [c for c in sets[n:] if c.joints]
    return Screened(stack, tuple(sets[:n]), (*candidates, *effects))


def _of_all(
    joints: Sequence[FittedJoint], terms: Sequence[EffectTerm], first: int
) -> list[Candidate]:
    """Effects common to all joints, their columns in order from a given index."""
    names, found = tuple(j.name for j in joints), []
    for term in terms:
        at = first + np.arange(len(term.coefficients))
        room = np.array(term_bounds(joints[0].prepared, term))
        found.append(Candidate(at, names, effect=term.name, common=term, first=first, room=room))
        first += len(at)
    return found


def _start(joints: Sequence[FittedJoint], clock: Clock, found: Found, cause: Cause) -> Array:
    """Numbers at which a cause's columns are computed: no cause, or a better start.

    Columns of a homogeneous cause are exact along a ray from zero.
    """
    if not cause.homogeneous:
        return cause.start
    start = found.with_cause(cause, cause.start)
    return descended(joints, clock, start, lambda label: False).numbers[-1]


def _append(columns: Array, more: Array, size: int) -> Array:
    """Columns padded with zeros, so that others begin at a given index."""
    room = np.zeros((len(columns), size - columns.shape[1]))
    return np.column_stack([columns, room, more])
