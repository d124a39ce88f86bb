"""Every shared cause and every joint's own effects against what all joints leave."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.library import effects
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.basis import orthonormal
from frictionjoint.identify.design import lengths
from frictionjoint.identify.terms import EffectTerm, Timing
from frictionjoint.robot.causes.cause import Cause, composed
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.common import common_columns
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import Columns, JointGram, Stack, joint_gram

# fraction of a joint's squares that an effect of its own must explain to compete
_LITTLE = 0.02
_DEPENDENT = 1e-6
# norm of a column over the largest one's, below which it is the rounding of a difference
_NOTHING = 1e-8
# how often the end of a ray is solved again, and part of the squares by which it must leave less
_MOST_TURNS, _SAME = 5, 0.01


@dataclass(frozen=True)
class Candidate:
    """A shared cause, or an effect of one joint or of all that explains the same residual.

    Attributes:
        cause: None for an effect. effect: name of that. common: of all joints alike.
        at: columns of the stack, from `first` on. joints: where it acts.
        room: how far each number of a cause may move either way, shape (k, 2).
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
        """Whether it is a cause of the robot, not of one joint."""
        return self.cause is not None or self.common is not None

    @property
    def among(self) -> float:
        """How many lines of a spectrum it is the strongest of."""
        return self.cause.among if self.cause else 1.0

    @property
    def order(self) -> int:
        """Place among all candidates."""
        return self.first

    @property
    def changed(self) -> str:
        """What all forms of one change have in common."""
        return self.cause.changed if self.cause else self.label

    @property
    def label(self) -> str:
        """What it is and where."""
        if self.cause is None:
            return f"{self.effect} of {', '.join(self.joints)}"
        place = ", ".join(self.cause.place.values())
        return f"{self.cause.name} of {place}" if place else self.cause.name


@dataclass(frozen=True)
class Found:
    """Shared causes in a model, with their numbers.

    Attributes:
        original: the model as it is.
    """

    original: Corrections = field(repr=False)
    causes: tuple[Cause, ...] = ()
    numbers: tuple[Array, ...] = ()

    @property
    def state(self) -> Corrections:
        """The model with them."""
        return composed(self.causes, self.numbers, self.original)

    def without(self, *out: int) -> "Found":
        """All but some, by number."""
        kept = [i for i in range(len(self.causes)) if i not in out]
        causes, numbers = self.causes, self.numbers
        return replace(
            self,
            causes=tuple(causes[i] for i in kept),
            numbers=tuple(numbers[i] for i in kept),
        )

    def with_cause(self, cause: Cause, x: Array) -> "Found":
        """One more."""
        return Found(self.original, (*self.causes, cause), (*self.numbers, x))

    def pairs(self, i: int) -> list[tuple[Corrections, Corrections, float]]:
        """States below and above each number of a cause."""
        found = []
        for k, step in enumerate(self.causes[i].steps):
            ends = []
            for sign in (-1.0, 1.0):
                x = self.numbers[i].copy()
                x[k] += sign * step
                ends.append(
                    composed(
                        self.causes,
                        (*self.numbers[:i], x, *self.numbers[i + 1 :]),
                        self.original,
                    )
                )
            found.append((ends[0], ends[1], 2.0 * float(step)))
        return found


@dataclass(frozen=True)
class Screened:
    """The stack and what its columns are.

    Attributes:
        taken: of the causes in the model already. candidates: of what may come.
    """

    stack: Stack
    taken: tuple[Candidate, ...]
    candidates: tuple[Candidate, ...]

    def without(self, candidate: Candidate) -> "Screened":
        """But for a cause, in whatever numbers of it are free."""
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
        found: causes in the model. causes: those that may come.
        own: which of the joints' own effects compete, by label. common: effects of all alike.
        shaped: the joints by whose residual their own effects have their shapes; none: `joints`.
    """
    starts = _starts(joints, clock, found, causes)
    return _screen(joints, clock, found, causes, starts, own, common, shaped)


def _screen(
    joints: Sequence[FittedJoint],
    clock: Clock,
    found: Found,
    causes: Sequence[Cause],
    starts: Sequence[Array],
    own: Callable[[str], bool],
    common: Sequence[EffectTerm] = (),
    shaped: Sequence[FittedJoint] = (),
) -> Screened:
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
            columns, size = _beside(columns, x, size), size + x.shape[1]
        parts.append(columns)
    norms = [np.linalg.norm(x, axis=0) for x in parts]
    grams = []
    acts: dict[int, list[str]] = {}
    for joint, x, norm in zip(joints, parts, norms, strict=True):
        at = np.flatnonzero(norm > _NOTHING * norm.max(initial=0.0))
        for k in at:
            acts.setdefault(int(k), []).append(joint.name)
        grams.append(gram_of(joint, x, at, clock))
    numbers = [*found.numbers, *(c.start for c in causes)]
    precision, pull = np.zeros(size), np.zeros(size)
    for at, cause, x in zip(shared, (*found.causes, *causes), numbers, strict=True):
        precision[at] = cause.prior**-2.0
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
    """Effects of all joints alike, their columns one after the other from a number on."""
    names, found = tuple(j.name for j in joints), []
    for term in terms:
        at = first + np.arange(len(term.coefficients))
        found.append(Candidate(at, names, effect=term.name, common=term, first=first))
        first += len(at)
    return found


def _starts(
    joints: Sequence[FittedJoint], clock: Clock, found: Found, causes: Sequence[Cause]
) -> list[Array]:
    """Numbers where each cause's columns are taken: where it is nothing, or what is better.

    Columns of a homogeneous cause are exact along a ray from where it is nothing.
    """
    return [_end(joints, clock, found, c) if c.homogeneous else c.start for c in causes]


def _end(joints: Sequence[FittedJoint], clock: Clock, found: Found, cause: Cause) -> Array:
    """End of a ray: a first solution, and what may lie behind it, solved again from there."""
    end, starts, least = cause.start, [cause.start], np.inf
    for _ in range(_MOST_TURNS):
        seen = _screen(joints, clock, found, [cause] * len(starts), starts, lambda label: False)
        known = np.arange(sum(len(c.at) for c in seen.taken))
        tried = []
        for start, candidate in zip(starts, seen.candidates, strict=False):
            at = np.concatenate([known, candidate.at])
            left = float(seen.stack.held_out(at).sum())
            tried.append((left, start, seen.stack.solution(at)[len(known) :]))
        left, start, x = min(tried, key=lambda one: one[0], default=(np.inf, end, end))
        if left > (1.0 - _SAME) * least:
            break
        # where a cause is nothing, what grows with the square of its numbers is left out
        starts, least = ([x], left) if np.any(start) else (cause.rays(x), np.inf)
        end = start
    return end


def _beside(columns: Array, more: Array, size: int) -> Array:
    """Columns with others from a number on, zero between."""
    room = np.zeros((len(columns), size - columns.shape[1]))
    return np.column_stack([columns, room, more])


def own_effects(
    joint: FittedJoint, clock: Clock, own: Callable[[str], bool]
) -> list[tuple[Candidate, Array]]:
    """Each of the joint's own effects that explains some of its residual, and its columns."""
    named = {
        e.name: Candidate(np.zeros(0, dtype=np.int64), (joint.name,), effect=e.name)
        for e in CATALOGUE
    }
    wanted = {name for name, candidate in named.items() if own(candidate.label)}
    if not wanted:
        return []
    law, e = law_columns(joint), joint.residual * joint.fit.weight
    base = orthonormal(law / lengths(law))
    best: dict[str, tuple[float, Array]] = {}
    found = effects(
        joint.prepared,
        joint.fit,
        clock.blocks(joint),
        lambda effect: effect.name in wanted and not effect.delays,
    )
    for candidate in found:
        term = candidate.term
        x = candidate.columns * joint.fit.weight[:, None]
        x = x - base @ (base.T @ x)
        explained = float(e @ x @ np.linalg.lstsq(x, e, rcond=_DEPENDENT)[0])
        if explained > max(best.get(term.name, (_LITTLE * float(e @ e),))[0], 0.0):
            best[term.name] = (explained, candidate.columns)
    return [(named[name], x) for name, (_, x) in best.items()]


def law_columns(joint: FittedJoint) -> Array:
    """Weighted columns of the joint's own law, shape (n, p)."""
    fitted = joint.fit
    free = ~fitted.bound
    for i, term in enumerate(fitted.terms):
        # a delay at the end of its sample is no longer one of sampling
        if isinstance(term, Timing) and term.at_its_end:
            free[fitted.layout.numbers(i)] = False
    return np.asarray(fitted.jacobian[:, free] * fitted.weight[:, None])


def gram_of(joint: FittedJoint, columns: Array, at: Columns, clock: Clock) -> JointGram:
    """Gram matrices of some of a joint's columns, in units of what its fit leaves."""
    fitted = joint.fit
    unit = (fitted.weight / joint.left)[:, None]
    grams = joint_gram(
        law_columns(joint) / joint.left,
        columns * unit,
        joint.residual * unit[:, 0],
        at,
        clock.of_sample(joint),
        clock.count,
    )
    friction = float(np.sqrt(np.mean((fitted.friction * fitted.weight) ** 2)))
    return JointGram(joint.name, len(fitted.residual), grams, at, joint.left, friction)
