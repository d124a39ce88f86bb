"""Other causes that explain as much, some with fewer numbers, and whether logs agree on a size.

While causes are missing, many candidates look alike. A candidate that was as good as a cause when
it was accepted may be far worse together with all the others, or be in the model itself by then.
Another name of the same change of a body may be as good only with the final laws.

A search that takes the best single cause first may accept a body with all its ten parameters
instead of a mass and a rotor, or a payload instead of a torque scale, or two causes with one number
each instead of a third. While missing causes bias the laws, the sums of squares do not show which;
with unbiased laws the fewest numbers suffice.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.effects.catalogue import title
from frictionjoint.identify.rounding import EQUAL
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.recordings.between import Between
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.choose import Choice, within_bounds
from frictionjoint.robot.columns import Candidate
from frictionjoint.robot.compare import as_good, gain_of, nearer
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.settle import Settled


def with_alternatives(settled: Settled, causes: Sequence[Cause]) -> tuple[Choice, ...]:
    """The evidence for each cause of a model, with the alternatives that remain on this model."""
    found, joints, single_effects = settled.found, settled.joints, settled.single_effects
    left = settled.squares_left()
    there = {c.label for c in found.causes} | single_effects
    kept = []
    for i, choice in enumerate(settled.choices):
        wanted = frozenset(choice.evidence.ties) - there
        own, rest = found.causes[i], settled.corrected(found.without(i))
        ties = dict.fromkeys(_renamed(rest, own, causes, left))
        if wanted:
            rivals = [c for c in causes if c.label in wanted and c.changed != own.changed]
            named, common = (single_effects | wanted).__contains__, joints[0].common_effects
            seen = screen(
                rest.joints, rest.clock, rest.found, [own, *rivals], named, common, joints
            )
            ties |= dict.fromkeys(_as_good(seen, own, wanted, left))
        kept.append(replace(choice, evidence=replace(choice.evidence, ties=tuple(ties))))
    return tuple(kept)


def _renamed(rest: Settled, own: Cause, causes: Sequence[Cause], left: Array) -> Iterator[str]:
    """Labels of other causes that change the same body as `own`, a cause of the model, with no more
    parameters and a residual as small as `left`, the model's; `rest` is the model without `own`."""
    for c in causes:
        other = c.changed == own.changed and c.label != own.label
        if other and len(c.start) <= len(own.start):
            # they are nonlinear far from the nominal parameters
            trial = rest.fitted_with([c])
            if as_good(trial.screened().stack, trial.squares_left(), left):
                yield c.label


def _as_good(seen: Screened, own: Cause, wanted: frozenset[str], left: Array) -> Iterator[str]:
    """Labels among `wanted` whose residual is as small as `left`, that of the model with `own`."""
    open_ones = [c for c in seen.candidates if c.label in wanted]
    itself = next(c for c in seen.candidates if c.cause == own)
    stand = [c for c in seen.candidates if c is not itself and c.label not in wanted]
    alone = float(seen.held_out((*stand, itself)).sum())
    for c in open_ones:
        # a column that adds nothing is the same cause under the name of a joint's effect
        both = float(seen.held_out((*stand, itself, c)).sum())
        same = abs(both - alone) <= EQUAL * alone
        if not same and as_good(seen.stack, seen.held_out((*stand, c)), left):
            yield c.label


def disagreements(shared: Settled) -> tuple[str, ...]:
    """A note for each cause of which single logs show different parts, to first order, with the
    laws and the other causes common to all logs. Logs disagree if parts of their own remove as
    much of the residual as an effect that is named."""
    log, names = shared.clock.log, [name for name, _ in shared.clock.number]
    if len(names) < 2:
        return ()
    seen, notes, blocks = shared.screened(), [], np.bincount(log)
    left = dict(zip([j.name for j in seen.stack.joints], seen.stack.squares, strict=True))
    for own, choice, x in zip(seen.accepted, shared.choices, shared.found.numbers, strict=True):
        others = np.setdiff1d(seen.columns(seen.candidates), own.at)
        grams, scores = seen.stack.products(own.at, others)
        # of each block: squares of the torque that the cause moves, and product with the residual
        moved, along = np.einsum("i,bij,j->b", x, grams, x), scores @ x
        squares, product = (np.bincount(log, y) for y in (moved, along))
        acts = squares > 1e-3 * squares.max(initial=0.0)
        if acts.sum() < 2:
            continue
        part = np.divide(product, squares, out=np.zeros(len(names)), where=acts)[acts]
        missed = along[acts[log]] - np.repeat(part, blocks[acts]) * moved[acts[log]]
        variance = np.bincount(log[acts[log]], missed**2, len(names)) * blocks / (blocks - 1)
        error = np.sqrt(variance[acts]) / squares[acts]
        between = Between(part, error, float(np.sum(blocks[acts] - 1)))
        mean = squares[acts] @ part / squares[acts].sum()
        removed = squares[acts] @ (part - mean) ** 2
        if between.p_value > SIGNIFICANCE:
            continue
        if removed < SMALLEST_GAIN * sum(left[name].sum() for name in own.joints):
            continue
        pairs = zip(np.array(names)[acts], part, error, strict=True)
        each = ", ".join(f"{name} {1.0 + p:.2g} ± {e:.1g}" for name, p, e in pairs)
        notes.append(
            f"The logs disagree on {title(choice.candidate.label)}: of the stated change they show "
            f"{each} (1: all of it). If a load was changed between them, analyse those with one "
            "load together."
        )
    return tuple(notes)


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
    """New causes and effects as candidates, kept effects as accepted ones; those of single joints
    keep the shapes they have with the removed causes, which a fit without these would bias."""
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
    """Single causes and pairs with fewer numbers; a cause that compensates for another can be past
    its bounds alone, and within its bounds together with that cause."""
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
