"""The closed loop: fit, trace the residual, add an effect, refit, until nothing is justified."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from frictionjoint.diagnose.choice import (
    LARGE_GAIN,
    LAW_BOUND,
    SMALLEST_GAIN,
    Choice,
    choose,
    justified,
    large_enough,
    least_gain,
)
from frictionjoint.diagnose.floor import AT_THE_FLOOR, noise_floor
from frictionjoint.diagnose.law_choice import OTHERS, clearly_better, fit_others, with_better_law
from frictionjoint.diagnose.pairs import first_of_two
from frictionjoint.diagnose.ranking import (
    at_an_end,
    barring,
    beside_unbent,
    rank_all,
    with_refits,
)
from frictionjoint.diagnose.revision import exchanged, reconsidered, without_idle
from frictionjoint.diagnose.step import Step, step_of
from frictionjoint.diagnose.timing import timed
from frictionjoint.diagnose.trace import Ranked, Ranking
from frictionjoint.identify.fit import ROUGH, Fit, fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.rest import resolved
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import ExcessTerm
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import Term
from frictionjoint.parameters import FrictionParameters
from frictionjoint.threads import one_thread

INTEGRATED_LAW = FrictionParameters.law

# An effect that explains less than this beside nothing else is of no use.
_USELESS = 0.02
_MOST_STEPS = 8


@dataclass(frozen=True)
class Trace:
    """Outcome of the loop.

    Attributes:
        prepared: the logs, without the rest that the position does not resolve.
        base: fit of the law alone. steps: additions in order. final: the last fit.
        unexplained: smooth curves that still explain something, best first.
        last_ranking: candidates against the final residual.
        other: the same additions to the law that is not reported: the better one where a law was
            asked for, else the one of the base fit; None where these are the same.
    """

    prepared: Prepared
    base: Fit
    steps: tuple[Step, ...]
    final: Fit
    unexplained: tuple[Ranked, ...]
    last_ranking: Ranking
    other: Fit | None


@one_thread
def trace(
    prepared: Prepared,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    law: str | None = None,
) -> Trace:
    """Run the loop on prepared logs; uses these logs only, split into folds.

    Effects are looked for with a better law where there is one, so that what the first law cannot
    copy does not pass for them. Which law is better is asked before the first effect, after every
    large one, and once no other is found.

    Args:
        seed: of flips and resampling; equal seeds give equal results.
        progress: told what is being done.
        law: name of the friction law of the result; None for the integrated law, or a better one
            where there is one.
    Raises:
        ParameterError: no law has this name.
    """
    rng = np.random.default_rng(seed)
    progress("base fit")
    forms = forms_of(law or INTEGRATED_LAW)
    base = fit(prepared, progress=progress, forms=forms)
    progress("rest")
    prepared, base = resolved(*settled(prepared, base), forms)
    others = fit_others(prepared, base, progress)
    alone, forms_alone = (others, OTHERS) if clearly_better(others, base) else (base, forms)
    grown = _traced(prepared, alone, forms_alone, rng, progress)
    if grown.forms is forms and _in_doubt(grown):
        # an effect that hides behind one law may show behind another
        second = _traced(prepared, others, OTHERS, rng, progress)
        alike = second.fit.residual.size == grown.fit.residual.size
        # what holds the measured torque itself leaves little of it, whatever else is wrong
        circular = any(isinstance(t, ExcessTerm) for t in second.fit.terms)
        if alike and not circular and clearly_better(second.fit, grown.fit):
            alone, forms_alone, grown = others, OTHERS, second
    prepared, current, steps, ranking = grown.prepared, grown.fit, grown.steps, grown.ranking
    if base.residual.size != current.residual.size:
        base = fit(prepared, forms=forms)
    named = [s for s in steps if not s.evidence.candidate.smooth]
    final = current
    if len(named) < len(steps):
        # where the curves bent the law, it may now lie in a poor valley
        final = _better(prepared, tuple(s.term for s in named), (current, alone))
        # what explained something beside a curve may explain nothing without it
        named, final = without_idle(prepared, named, final, lambda name: _USELESS, last=True)
        if not named:
            final = base if forms_alone is forms else fit(prepared, start=alone.shape)
    # what came first may be idle beside what came later
    named, final = without_idle(prepared, named, final, least_gain, last=False)
    untimed, final = final, timed(prepared, final)
    if final is not current:
        ranking = with_refits(prepared, final, rank_all(prepared, final, rng))
    unexplained = _unexplained(ranking, final, steps)
    other = None
    if law_parameters(final).law != law_parameters(base).law:
        if law:
            named, restated = _restated(prepared, base, named, untimed)
            final, other = timed(prepared, restated), final
        else:
            other = fit(prepared, final.terms, start=base.shape, closeness=ROUGH)
    return Trace(prepared, base, tuple(named), final, unexplained, ranking, other)


def _restated(
    prepared: Prepared, base: Fit, steps: list[Step], traced: Fit
) -> tuple[list[Step], Fit]:
    """The same additions, one after the other, to the law of the base fit."""
    found, current = [], base
    for step, term in zip(steps, traced.terms, strict=True):
        current = fit(prepared, (*current.terms, term), start=current.shape)
        found.append(replace(step, fit=current))
    return found, current


class _Grown(NamedTuple):
    """Where adding effects has come to; the ranking is that of the last residual."""

    prepared: Prepared
    fit: Fit
    steps: list[Step]
    ranking: Ranking
    forms: Sequence[Shape]


def _traced(
    prepared: Prepared,
    alone: Fit,
    forms: Sequence[Shape],
    rng: np.random.Generator,
    progress: Callable[[str], None],
) -> _Grown:
    """Effects added to the fit of a law alone, the first of them looked at once more."""
    grown = _grown(prepared, alone, [], rng, progress, forms)
    # the last effect was chosen beside all others, but not with a law found better after it
    again = grown.steps if grown.forms is not forms else grown.steps[:-1]
    if not again:
        return grown
    progress("looking again at what was added first")
    current, steps = reconsidered(grown.prepared, grown.fit, grown.steps, len(again), rng)
    if steps is grown.steps:
        return grown
    return _grown(grown.prepared, current, steps, rng, progress, grown.forms)


def _in_doubt(grown: _Grown) -> bool:
    """Whether more than noise is left, and nothing that the loop has seen without naming it."""
    if any(s.evidence.candidate.smooth for s in grown.steps):
        return False
    return grown.fit.rms > AT_THE_FLOOR * noise_floor(grown.prepared, grown.fit.gain)


def _grown(
    prepared: Prepared,
    current: Fit,
    steps: list[Step],
    rng: np.random.Generator,
    progress: Callable[[str], None],
    forms: Sequence[Shape],
) -> _Grown:
    """Add effects until none is justified with any law."""
    steps = list(steps)
    barred: set[str] = set()
    while True:
        number = len(steps) + 1
        progress(f"step {number}: trying candidates")
        # A motor driven by a voltage has a back-EMF: that is asked first and alone, for without
        # it the gain of the drive, and with it every torque, is off.
        chosen = unbent = None
        if prepared.voltage_driven and not steps:
            ranking = rank_all(prepared, current, rng, "back-emf")
            chosen = choose(ranking, current, rng)
        if chosen is None:
            ranking = barring(rank_all(prepared, current, rng), barred)
            ranking = with_refits(prepared, current, ranking)
            chosen = choose(ranking, current, rng) if number <= _MOST_STEPS else None
            if chosen and chosen.winner.candidate.smooth:
                ranking, unbent = beside_unbent(prepared, current, ranking, chosen.winner)
                chosen = choose(ranking, current, rng)
            if chosen and chosen.winner.candidate.smooth:
                first = first_of_two(prepared, current, ranking, chosen.winner)
                chosen = Choice(first) if first else chosen
        if chosen is None:
            own = current
            if steps:
                current, forms = with_better_law(prepared, current, forms, progress)
            if current is own:
                return _Grown(prepared, current, steps, ranking, forms)
            continue
        winner = chosen.winner
        if better := exchanged(prepared, current, steps, winner.held_out_gain, rng):
            progress(f"step {number}: another choice before it")
            current, steps = better
            continue
        progress(f"step {number}: adding {winner.name}")
        # after a large change, and with an effect that bends the law's own curves, the old shape
        # may sit in another valley: start from everywhere
        near = winner.held_out_gain < LARGE_GAIN and winner.name not in LAW_BOUND
        start = current.shape if near else None
        terms = (*current.terms, winner.candidate.term)
        refitted = fit(prepared, terms, start=start, forms=forms)
        if unbent and winner.name in LAW_BOUND:
            other = fit(prepared, terms, start=unbent)
            refitted = min(refitted, other, key=lambda f: f.drive_rms)
        if winner.candidate.slow and at_an_end(refitted.terms[-1]):
            # what changes as fast as its range allows is of the motion, and is not to be told by
            # what a log holds later
            barred.add(winner.name)
            continue
        if not near and forms is not OTHERS:
            # those were all tried just now
            refitted, forms = with_better_law(prepared, refitted, forms, progress)
        prepared, current = resolved(*settled(prepared, refitted), forms)
        steps.append(step_of(chosen, current, ranking, rng))


def _better(prepared: Prepared, terms: tuple[Term, ...], starts: Sequence[Fit]) -> Fit:
    """The better of the fits from some places."""
    return min((fit(prepared, terms, start=s.shape) for s in starts), key=lambda f: f.drive_rms)


def _unexplained(ranking: Ranking, current: Fit, steps: Sequence[Step]) -> tuple[Ranked, ...]:
    """Curves that still explain something, and those that the loop had to put in for a cause."""
    needed = {(s.evidence.name, s.evidence.candidate.kind) for s in steps}
    best: dict[str, Ranked] = {}
    for r in ranking.ranked:
        asked_for = justified(r) or (r.name, r.candidate.kind) in needed
        if r.candidate.smooth and asked_for and r.held_out_gain >= SMALLEST_GAIN:
            best.setdefault(r.name, r)
    return tuple(r for r in best.values() if large_enough(r, current))
