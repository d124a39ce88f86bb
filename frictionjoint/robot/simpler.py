"""Fewer numbers that explain as much: one or two simpler causes in the place of a rich one.

A search that takes the best single cause first may take a body with all its ten parameters for what
are a mass and a rotor. Once the laws are straight, both are compared.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.choose import Choice, columns_of, within_bounds
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.compare import as_much, gain_of
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Candidate, Found, Screened, screen
from frictionjoint.robot.stack import Columns

# numbers from which on a cause is rich
RICH = 4
# single causes of which pairs are tried, those that explain most
_LEADERS = 8
# part of the squares by which sets differ that no log distinguishes
_ALIKE = 1e-3


def simpler(
    joints: Sequence[FittedJoint],
    clock: Clock,
    found: Found,
    choices: Sequence[Choice],
    causes: Sequence[Cause],
    beside: frozenset[str],
) -> tuple[int, tuple[Choice, ...]] | None:
    """A cause of the model, and what explains as much with fewer numbers; None: there is none.

    Args:
        joints: with their laws fitted under `found`; choices: of its causes.
        causes: all that may come. beside: labels of effects of single joints that compete.
    """
    if all(len(cause.start) < RICH for cause in found.causes):
        return None
    own = beside.__contains__
    now = screen(joints, clock, found, (), own)
    left = now.stack.held_out(columns_of((*now.taken, *now.candidates)))
    for i, cause in enumerate(found.causes):
        size = len(cause.start)
        if size < RICH:
            continue
        rest = found.without(i)
        fewer = [c for c in causes if len(c.start) < size and c not in rest.causes]
        seen = screen([j.corrected(rest.state) for j in joints], clock, rest, fewer, own)
        known = columns_of((*seen.taken, *(c for c in seen.candidates if c.cause is None)))
        tried = [
            (sum(len(c.at) for c in several), float(squares.sum()), several)
            for several in _sets(seen, known, size)
            if as_much(squares := seen.stack.held_out(_with(known, several)), left)
        ]
        if tried:
            return i, _choices(seen, known, _simplest(tried), choices[i])
    return None


def _simplest(tried: Sequence[tuple[int, float, tuple[Candidate, ...]]]) -> tuple[Candidate, ...]:
    """Fewest numbers, then fewest squares; of sets that leave alike, the catalogue's first."""
    fewest = min(numbers for numbers, _, _ in tried)
    left = min(squares for numbers, squares, _ in tried if numbers == fewest)
    alike = [x for n, squares, x in tried if n == fewest and squares <= (1.0 + _ALIKE) * left]
    return min(alike, key=lambda several: sorted(c.order for c in several))


def _sets(seen: Screened, known: Columns, size: int) -> list[tuple[Candidate, ...]]:
    """Single causes and pairs of fewer numbers."""
    singles = [
        inside
        for c in seen.candidates
        if c.cause and (inside := within_bounds(seen.stack, c, known)) is not None
    ]
    singles.sort(key=lambda c: float(seen.stack.held_out(_with(known, (c,))).sum()))
    pairs = itertools.product(singles[:_LEADERS], singles)
    return [(c,) for c in singles] + [
        (a, b)
        for a, b in pairs
        if len(a.at) + len(b.at) < size and a.changed != b.changed and _possible(seen, known, a, b)
    ]


def _possible(seen: Screened, known: Columns, a: Candidate, b: Candidate) -> bool:
    """Whether all numbers of both are within their bounds beside each other."""
    inside = [
        within_bounds(seen.stack, one, _with(known, (other,))) for one, other in ((a, b), (b, a))
    ]
    return [len(c.at) if c else 0 for c in inside] == [len(a.at), len(b.at)]


def _with(known: Columns, several: Sequence[Candidate]) -> Columns:
    return np.concatenate([known, columns_of(several)])


def _choices(
    seen: Screened, known: Columns, several: tuple[Candidate, ...], before: Choice
) -> tuple[Choice, ...]:
    """Each with the evidence of the cause in whose place it comes, and its own gain."""
    whole = seen.stack.held_out(_with(known, several))
    numbers = seen.stack.solution(_with(known, several))[len(known) :]
    parts = np.split(numbers, np.cumsum([len(c.at) for c in several])[:-1])
    found = []
    for candidate, x in zip(several, parts, strict=True):
        others = tuple(c for c in several if c is not candidate)
        without = seen.stack.held_out(_with(known, others))
        found.append(
            replace(
                before,
                candidate=candidate,
                gain=gain_of(without, whole),
                runner_up=before.candidate.label,
                margin=0.0,
                ties=tuple(t for t in before.ties if t != candidate.label),
                numbers=x,
            )
        )
    return tuple(found)
