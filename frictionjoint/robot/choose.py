"""Forward selection of shared causes over all joints at once.

One score decides: the sum of squares of all joints predicted by coefficients fitted to other
motion. The joints' own effects compete for the same residual, so that a cause of one joint is not
mistaken for one of the robot. Winning effects are projected out here and named by each joint's own
search.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import SIGNIFICANCE, TIE
from frictionjoint.diagnose.chance import FLIPS, over_family
from frictionjoint.diagnose.state import MOST_CHANGES
from frictionjoint.identify.blocks import halves
from frictionjoint.identify.rounding import first_least, in_order
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.report.entries import Evidence
from frictionjoint.robot import compare
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.columns import Candidate, columns_of
from frictionjoint.robot.screen import Screened
from frictionjoint.robot.stack import Columns, Stack

# gain from which on a cause that was missing may have distorted the fitted laws: the residual is
# examined again after they are refitted
_BENT = 0.3


@dataclass(frozen=True)
class Choice:
    """A selected candidate with its evidence.

    Attributes:
        evidence: its gain is the fraction of held-out squares that it removes of the joint with
            the largest; its p-value is over the whole family, its margin over all joints.
        numbers: of the cause, to first order, for its free columns, next to all others.
    """

    candidate: Candidate
    evidence: Evidence
    numbers: Array = field(default_factory=lambda: np.zeros(0), repr=False)

    @property
    def parts(self) -> list[tuple[Cause, Array]]:
        """The causes of one body or joint of which its cause consists, with all their numbers."""
        assert self.candidate.cause is not None
        x = self.candidate.cause.start.copy()
        x[self.candidate.at - self.candidate.first] = self.numbers
        return self.candidate.cause.parts(x)

    def of(self, cause: Cause) -> "Choice":
        """The choice for a part of its cause."""
        joints = tuple(j for j in self.candidate.joints if cause.acts_on(j))
        return replace(self, candidate=replace(self.candidate, cause=cause, joints=joints))


@dataclass(frozen=True)
class _Row:
    """A candidate added to the selected ones: sums of squares by joint and block, (J, B)."""

    candidate: Candidate
    left: Array = field(repr=False)
    p_value: float

    @property
    def total(self) -> float:
        return float(self.left.sum())


def choose(
    screened: Screened, rng: np.random.Generator, standing: Sequence[EffectTerm]
) -> list[Choice]:
    """Select candidates one after the other, including the joints' own, until none is justified.

    Args:
        standing: effects common to all joints that were fitted together with the laws. They come
            first, with their best present shape, unless they are no longer justified.
    """
    choices: list[Choice] = []
    names = {term.name for term in standing}
    if names:
        choice = _next(screened, choices, rng, lambda c: bool(c.common) and c.effect in names)
        choices += [choice] if choice else []
    for _ in range(MOST_CHANGES):
        choice = _next(screened, choices, rng)
        if choice is None:
            break
        choices.append(choice)
        if choice.candidate.shared and choice.evidence.held_out_gain > _BENT:
            break
    return _together(screened, choices)


def _together(screened: Screened, choices: Sequence[Choice]) -> list[Choice]:
    """Remove effects of single joints that later candidates replace; fit all numbers together. A
    cause that seems to harm a joint whose own effect is not found yet is selected only after an
    effect that imitates it in another joint."""
    kept = list(choices)

    def left(some: Sequence[Choice]) -> Array:
        return screened.held_out(c.candidate for c in some)

    while len(kept) > 1:
        now, idle_ones = left(kept), []
        for i, choice in enumerate(kept):
            if not choice.candidate.shared:
                without = left(kept[:i] + kept[i + 1 :])
                if not compare.improves(screened.stack, without, now):
                    idle_ones.append((compare.joint_gain(without, now), i))
        if not idle_ones:
            break
        del kept[min(idle_ones)[1]]
    numbers = screened.numbers([c.candidate for c in kept])
    return [replace(c, numbers=x) for c, x in zip(kept, numbers, strict=True)]


def redundant(screened: Screened, without: Sequence[Screened]) -> list[tuple[int, Array]]:
    """Indices of causes whose removal does not worsen the prediction, the least useful first, and
    the ratios of the sums of squares without and with each, by joint, (J,).

    Args:
        screened: model; effects common to all joints are kept with the causes, those of single
            joints are not, because they would compensate for the harm of a cause.
        without: the model without each cause.
    """
    now, found = _left_by_robot(screened), []
    for i, rest in enumerate(without):
        left = _left_by_robot(rest)
        if not compare.improves(screened.stack, left, now):
            found.append((compare.joint_gain(left, now), i, compare.left_of(now, left)))
    found.sort(key=lambda one: one[:2])
    return [(i, ratios) for _, i, ratios in found]


def _left_by_robot(screened: Screened) -> Array:
    """Sums of squares with causes in the model and effects common to all joints, (J, B)."""
    return screened.held_out(c for c in screened.candidates if c.shared)


def _next(
    screened: Screened,
    choices: Sequence[Choice],
    rng: np.random.Generator,
    wanted: Callable[[Candidate], bool] = lambda c: True,
) -> Choice | None:
    """The best of all candidates next to earlier choices, if it is wanted and justified."""
    accepted = (*screened.accepted, *(c.candidate for c in choices))
    stack, known = screened.stack, columns_of(accepted)
    now = stack.held_out(known)
    open_ones = [
        inside
        for c in screened.candidates
        if not any(_excluded(c, t) for t in accepted)
        if (inside := within_bounds(stack, c, known)) is not None
    ]
    signs = rng.choice([-1.0, 1.0], (FLIPS, stack.clock.count))
    found = np.array(
        [stack.surprise(c.at, known, c.room, signs) - np.log(c.among) for c in open_ones]
    )
    rows = [
        _Row(c, stack.held_out(np.concatenate([known, c.at])), float(p))
        for c, p in zip(open_ones, over_family(found), strict=True)
    ]
    rows = in_order(rows, lambda r: r.total)
    deviation = stack.deviation(known)
    good = [
        r
        for r in rows
        if _justified(stack, r, now) or _brings_back(stack, r, now, known, deviation)
    ]
    best = next((r for r in good if wanted(r.candidate)), None)
    shared = any(r.candidate.shared for r in good)
    if best is None or not (shared or compare.gain_of(now, best.left) > _BENT):
        return None
    total = float(now.sum())
    gain = total - best.total
    near = [
        r
        for r in good
        if r is best
        or (not compare.better(best.left, r.left) and total - r.total >= (1.0 - TIE) * gain)
    ]
    # fewest numbers first, then causes of the robot, in the catalogue's order
    simplest = min(
        (r for r in near if wanted(r.candidate)),
        key=lambda r: (len(r.candidate.at), r.candidate.cause is None, r.candidate.first),
    )
    label = simplest.candidate.label
    others = [r for r in rows if r.candidate.label != label]
    ties = dict.fromkeys(r.candidate.label for r in near if r.candidate.label != label)
    evidence = Evidence(
        compare.gain_of(now, simplest.left),
        simplest.p_value,
        _frequency(rows, simplest.candidate.changed, rng),
        others[0].candidate.label if others else None,
        (others[0].total - simplest.total) / total if others else 0.0,
        tuple(ties),
    )
    return Choice(simplest.candidate, evidence)


def _excluded(candidate: Candidate, accepted: Candidate) -> bool:
    """Whether a candidate is a form or shape of a selected one, and no richer one of it. Of effects
    common to all joints one is selected: what its shape leaves would be taken for another."""
    if candidate.common and accepted.common:
        return True
    richer = accepted.cause is not None and len(candidate.at) > len(accepted.at)
    return candidate.changed == accepted.changed and not richer


def within_bounds(stack: Stack, candidate: Candidate, known: Columns) -> Candidate | None:
    """The candidate without numbers that are at their bounds; None if no number remains."""
    at, room = candidate.at, candidate.room
    if not len(room):
        return candidate
    while len(at):
        x = stack.solution(np.concatenate([known, at]))[len(known) :]
        inside = (x >= room[:, 0]) & (x <= room[:, 1])
        if inside.all():
            return replace(candidate, at=at, room=room)
        if not inside[: candidate.essential].all():
            return None
        at, room = at[inside], room[inside]
    return None


def _justified(stack: Stack, row: _Row, now: Array) -> bool:
    better = compare.improves(stack, now, row.left) and not compare.harms(row.left, now)
    return better and row.p_value <= SIGNIFICANCE


def _brings_back(stack: Stack, row: _Row, now: Array, known: Columns, deviation: float) -> bool:
    """Whether a candidate explains as much and brings bodies back to their nominal values."""
    if not compare.nearer(0.0, deviation) or not compare.as_good(stack, row.left, now):
        return False
    return compare.nearer(stack.deviation(np.concatenate([known, row.candidate.at])), deviation)


def _frequency(rows: Sequence[_Row], thing: str, rng: np.random.Generator) -> float:
    """How often a cause, in any form, is best on random halves of the blocks."""
    best: dict[str, Array] = {}
    for row in rows:
        key = row.candidate.changed
        # the six best are compared
        if len(best) < 6 or key == thing:
            best.setdefault(key, row.left.sum(axis=0))
    names, left = list(best), np.array(list(best.values()))
    first = first_least(left @ halves(left.shape[1], rng).T)
    return float(np.mean(np.array(names)[first] == thing))
