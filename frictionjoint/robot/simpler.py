"""Replace one or two causes by one or two with fewer numbers that explain as much.

A search that takes the best single cause first may accept a body with all its ten parameters
instead of a mass and a rotor, or a payload instead of a torque scale, or two causes with one number
each instead of a third. While missing causes bias the laws, the sums of squares do not show which;
with unbiased laws the fewest numbers suffice.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.candidate import Candidate
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.choose import Choice, within_bounds
from frictionjoint.robot.compare import as_good, gain_of, nearer
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.settle import Settled


def simpler(
    settled: Settled, causes: Sequence[Cause], common: Sequence[EffectTerm]
) -> Iterator[tuple[tuple[int, ...], tuple[Choice, ...]]]:
    """Causes or common effects that explain as much as one or two causes with more numbers."""
    found, left = settled.found, settled.squares_left()
    # effects of all joints alike come one at a time
    alike = () if settled.joints[0].common_effects else common
    of_one, of_two = (itertools.combinations(range(len(found.causes)), k) for k in (1, 2))
    for out in (*of_one, *of_two):
        gone = [found.causes[i] for i in out]
        size = sum(len(c.start) for c in gone)
        # what stays in the model anyway is for a smaller set to be replaced
        fewer = [c for c in causes if len(c.start) < size and c not in found.causes]
        terms = [t for t in alike if len(t.coefficients) < size]
        if not fewer and not terms:
            continue
        rest = settled.corrected(found.without(*out))
        seen = _opened(rest, settled.joints, fewer, terms)
        tried, nearest = [], []
        for several in _sets(seen, size):
            if len(several) == 1 and several[0].changed in {c.changed for c in gone}:
                # causes are nonlinear far from the nominal parameters
                squares = rest.fitted_with(_causes(several)).squares_left()
            else:
                squares = seen.held_out(several)
            total = float(squares.sum())
            if as_good(seen.stack, squares, left):
                tried.append((_size(several), total, several))
            elif len(several) > 1 and all(c.cause for c in several):
                nearest.append((total, several))
        if not tried and nearest:
            # nor are two that change together: they count where bodies come back by them
            _, several = min(nearest, key=lambda one: one[0])
            after = rest.fitted_with(_causes(several))
            squares = after.squares_left()
            if nearer(after.found.deviation, found.deviation) and as_good(
                seen.stack, squares, left
            ):
                tried.append((_size(several), float(squares.sum()), several))
        if tried:
            yield out, _choices(seen, _simplest(tried), settled.choices[out[0]])


def _opened(
    rest: Settled,
    shaped: Sequence[FittedJoint],
    causes: Sequence[Cause],
    terms: Sequence[EffectTerm],
) -> Screened:
    """New causes and effects as candidates; effects that are kept are accepted.

    Effects of single joints keep the shapes they have with the removed causes, because a fit
    without these causes would bias the shapes.
    """
    here, own = rest.joints[0].common_effects, rest.single_effects.__contains__
    seen = screen(rest.joints, rest.clock, rest.found, causes, own, (*here, *terms), shaped)
    stands = [c for c in seen.candidates if not c.shared or c.common in here]
    open_ones = tuple(c for c in seen.candidates if c.shared and c.common not in here)
    return replace(seen, accepted=(*seen.accepted, *stands), candidates=open_ones)


def _causes(several: Sequence[Candidate]) -> list[Cause]:
    return [c.cause for c in several if c.cause]


def _size(several: Sequence[Candidate]) -> int:
    return sum(len(c.at) for c in several)


def _simplest(tried: Sequence[tuple[int, float, tuple[Candidate, ...]]]) -> tuple[Candidate, ...]:
    """Fewest numbers, then the smallest sum of squares; among equals, the catalogue's first."""
    fewest = min(numbers for numbers, _, _ in tried)
    left = min(squares for numbers, squares, _ in tried if numbers == fewest)
    # no log distinguishes sets within 0.1%
    alike = [x for n, squares, x in tried if n == fewest and squares <= 1.001 * left]
    return min(alike, key=lambda several: sorted(c.first for c in several))


def _sets(seen: Screened, size: int) -> list[tuple[Candidate, ...]]:
    """Single causes and pairs with fewer numbers.

    A cause can be past its bounds alone, because it compensates for another cause, and within its
    bounds together with that cause.
    """
    known = seen.columns(())
    inside = [within_bounds(seen.stack, c, known) for c in seen.candidates]
    pool = [one or c for one, c in zip(inside, seen.candidates, strict=True)]
    pool.sort(key=lambda c: float(seen.held_out((c,)).sum()))
    # pairs contain one of the eight best causes
    pairs = itertools.product(pool[:8], pool)
    return [(c,) for c in inside if c is not None] + [
        (a, b)
        for a, b in pairs
        if len(a.at) + len(b.at) < size
        and a.changed != b.changed
        and not (a.common and b.common)
        and _possible(seen, a, b)
    ]


def _possible(seen: Screened, a: Candidate, b: Candidate) -> bool:
    """Whether all numbers of both are within their bounds when fitted together."""
    inside = [within_bounds(seen.stack, x, seen.columns((y,))) for x, y in ((a, b), (b, a))]
    return [len(c.at) if c else 0 for c in inside] == [len(a.at), len(b.at)]


def _choices(seen: Screened, several: tuple[Candidate, ...], before: Choice) -> tuple[Choice, ...]:
    """Each with the evidence of the cause that it replaces, and its own gain."""
    whole = seen.held_out(several)
    found = []
    for candidate, x in zip(several, seen.numbers(several), strict=True):
        without = seen.held_out(c for c in several if c is not candidate)
        evidence = replace(
            before.evidence,
            held_out_gain=gain_of(without, whole),
            runner_up=before.candidate.label,
            margin=0.0,
            ties=tuple(t for t in before.evidence.ties if t != candidate.label),
        )
        found.append(Choice(candidate, evidence, x))
    return tuple(found)
