"""The closed loop: fit, trace the residual, add an effect, refit, until nothing is justified."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.candidates import (
    effect_candidates,
    excess_candidates,
    periodic_candidates,
    signals_of,
    smooth_candidates,
    wave_candidates,
)
from frictionjoint.diagnose.floor import AT_THE_FLOOR, noise_floor
from frictionjoint.diagnose.trace import (
    FLIPS,
    Ranked,
    Ranking,
    held_out_squares,
    margin,
    rank,
    selection_frequency,
)
from frictionjoint.identify.fit import ROUGH, Fit, fit, shape_limits
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.rest import resolved
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of, prompt_maxwell_slip
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import HysteresisTerm, SmoothTerm
from frictionjoint.identify.terms import Term
from frictionjoint.parameters import FrictionParameters
from frictionjoint.threads import one_thread

INTEGRATED_LAW = FrictionParameters.law
# the laws that take the integrated one's place where the residual of one is clearly smaller
_OTHERS = (*prompt_maxwell_slip(), *forms_of("lugre"), *forms_of("elastoplastic"))
_CLEARLY = 0.95

SIGNIFICANCE = 0.05
# Share of the residual's squares that an effect must take away: what takes less beside a residual
# that stays is as likely a by-product of whatever else is in it. Effects that bend the law's own
# curves gain more by chance, since the law is fitted anew with them.
SMALLEST_GAIN = 0.08
_OTHER_GAINS = {"dwell-time": 0.1, "nonlinear-viscous": 0.12}
# No friction law is exact. Against plants with other laws (GMS, LuGre, elasto-plastic) the base
# fit leaves 1 to 5% of the friction torque; effects that act on the edges of friction pick up to
# 1.2% of it. So an effect must move the torque by a share of the friction's rms to be named.
SMALLEST_SHARE = 0.008
_OTHER_SHARES = {
    "dwell-time": 0.005,
    "measurement-delay": 0.009,
    "nonlinear-viscous": 0.003,
    "frictional-lag": 0.011,
    "backlash": 0.02,
    "joint-elasticity": 0.025,
}
# Effects that the law's own parameters take for themselves: what they explain shows only when
# both are fitted at once.
_LAW_BOUND = frozenset(("dwell-time", "frictional-lag", "nonlinear-viscous"))
# How much more an effect must explain beside a curve that has no name.
_DOUBT = 2.0
_LARGE_GAIN = 0.5
# Effects within this share of the best gain, and within chance of it, count as equals.
_CLOSE = 0.05
# Two effects nearer than these are one to these logs, whatever the resampling says: shares of what
# the better one explains, and of what it leaves.
_SAME, _SAME_LEFT = 0.02, 0.25
# An effect that explains less than this share of what a curve explains is not the cause: in trials
# the true effect reached 0.93 and more.
_ENOUGH = 0.9
# An effect that explains less than this beside nothing else is of no use.
_USELESS = 0.02
# How many of the leading effects are compared after a joint refit, and the share of the leader's
# gain they need before it: an effect bound up with the law shows its whole gain only then.
_SHORTLIST, _CURVES, _LEAST_OF_LEADER = 4, 2, 0.15
_MOST_STEPS = 8
# nearness to the end of a physical range, over the number itself
_EDGE = 0.02


@dataclass(frozen=True)
class Step:
    """One addition.

    Attributes:
        term: what was added (its shape as of the final fit is in the fit).
        evidence: the winner's row. runner_up: the next effect, or None.
        margin: difference in held-out gain to it. ties: effects the logs cannot tell from it.
        frequency: share of resamples in which it stayed best.
        fit: the model after the joint refit. ranking: all candidates of this step.
    """

    term: Term
    evidence: Ranked
    runner_up: str | None
    margin: float
    ties: tuple[str, ...]
    frequency: float
    fit: Fit
    ranking: Ranking


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
    prepared, base = resolved(prepared, base, forms)
    others = _fit_others(prepared, base, progress)
    alone, forms_alone = (others, _OTHERS) if _clearly_better(others, base) else (base, forms)
    grown = _traced(prepared, alone, forms_alone, rng, progress)
    if grown.forms is forms and _in_doubt(grown):
        # an effect that hides behind one law may show behind another
        second = _traced(prepared, others, _OTHERS, rng, progress)
        alike = second.fit.residual.size == grown.fit.residual.size
        if alike and _clearly_better(second.fit, grown.fit):
            alone, forms_alone, grown = others, _OTHERS, second
    prepared, current, steps, ranking = grown.prepared, grown.fit, grown.steps, grown.ranking
    if base.residual.size != current.residual.size:
        base = fit(prepared, forms=forms)
    named = [s for s in steps if not s.evidence.candidate.smooth]
    final = current
    if len(named) < len(steps):
        # where the curves bent the law, it may now lie in a poor valley
        final = _better(prepared, tuple(s.term for s in named), (current, alone))
        # what explained something beside a curve may explain nothing without it
        named, final = _without_idle(prepared, named, final, lambda name: _USELESS, last=True)
        if not named:
            final = base if forms_alone is forms else fit(prepared, start=alone.shape)
    # what came first may be idle beside what came later
    named, final = _without_idle(prepared, named, final, _least_gain, last=False)
    if final is not current:
        ranking = _with_refits(prepared, final, _rank_all(prepared, final, rng))
    unexplained = _unexplained(ranking, final, steps)
    other = None
    if law_parameters(final).law != law_parameters(base).law:
        if law:
            named, other = _restated(prepared, base, named, final)
            final, other = other, final
        else:
            other = fit(prepared, final.terms, start=base.shape, closeness=ROUGH)
    return Trace(prepared, base, tuple(named), final, unexplained, ranking, other)


def _fit_others(prepared: Prepared, own: Fit, progress: Callable[[str], None]) -> Fit:
    """The terms of a fit with the best of the other laws.

    What a law cannot copy stays in its residual and passes for an effect. Generalized Maxwell-slip
    drops as its elements let go one after the other, which no parameters of the integrated law do.
    """
    progress("fit: other laws")
    return fit(prepared, own.terms, forms=_OTHERS)


def _clearly_better(other: Fit, own: Fit) -> bool:
    return other.drive_rms < _CLEARLY * own.drive_rms


def _with_better_law(
    prepared: Prepared, own: Fit, forms: Sequence[Shape], progress: Callable[[str], None]
) -> tuple[Fit, Sequence[Shape]]:
    """A fit of the same terms with another law, and what that tries, where it is clearly better."""
    if forms is _OTHERS or _CLEARLY * own.rms < noise_floor(prepared, own.gain):
        return own, forms
    other = _fit_others(prepared, own, progress)
    return (other, _OTHERS) if _clearly_better(other, own) else (own, forms)


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
    current, steps = _reconsidered(grown.prepared, grown.fit, grown.steps, len(again), rng)
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
    while True:
        number = len(steps) + 1
        progress(f"step {number}: trying candidates")
        # A motor driven by a voltage has a back-EMF: that is asked first and alone, for without
        # it the gain of the drive, and with it every torque, is off.
        chosen = None
        if prepared.voltage_driven and not steps:
            ranking = _rank_all(prepared, current, rng, "back-emf")
            chosen = _choose(ranking, current, rng)
        if chosen is None:
            ranking = _rank_all(prepared, current, rng)
            ranking = _with_refits(prepared, current, ranking)
            chosen = _choose(ranking, current, rng) if number <= _MOST_STEPS else None
            if chosen and chosen[0].candidate.smooth:
                ranking = _from_everywhere(prepared, current, ranking, forms)
                chosen = _choose(ranking, current, rng)
        if chosen is None:
            own = forms
            if steps:
                current, forms = _with_better_law(prepared, current, forms, progress)
            if forms is own:
                return _Grown(prepared, current, steps, ranking, forms)
            continue
        winner, ties = chosen
        progress(f"step {number}: adding {winner.name}")
        # after a large change, and with an effect that bends the law's own curves, the old shape
        # may sit in another valley: start from everywhere
        near = winner.held_out_gain < _LARGE_GAIN and winner.name not in _LAW_BOUND
        start = current.shape if near else None
        terms = (*current.terms, winner.candidate.term)
        refitted = fit(prepared, terms, start=start, forms=forms)
        if not near:
            refitted, forms = _with_better_law(prepared, refitted, forms, progress)
        prepared, current = resolved(prepared, refitted, forms)
        steps.append(_step(winner, ties, current, ranking, rng))


def _step(
    winner: Ranked, ties: tuple[str, ...], fitted: Fit, ranking: Ranking, rng: np.random.Generator
) -> Step:
    others = [r for r in ranking.ranked if r is not winner and not r.candidate.smooth]
    runner = others[0] if others else None
    gap = margin(winner, runner, ranking.base_squares, rng)[0] if runner else 0.0
    kin = tuple(r for r in ranking.ranked if r.candidate.smooth == winner.candidate.smooth)
    return Step(
        winner.candidate.term,
        winner,
        runner.name if runner else None,
        gap,
        ties,
        selection_frequency(winner, kin, rng),
        fitted,
        ranking,
    )


def _reconsidered(
    prepared: Prepared, current: Fit, steps: list[Step], first: int, rng: np.random.Generator
) -> tuple[Fit, list[Step]]:
    """The first choices once more, beside those that came after: a better one replaces each."""
    for i in range(first):
        rest = tuple(t for k, t in enumerate(current.terms) if k != i)
        without = fit(prepared, rest, start=current.shape, closeness=ROUGH)
        ranking = _rank_all(prepared, without, rng)
        chosen = _choose(ranking, without, rng)
        if chosen is None or chosen[0].name == steps[i].term.name:
            continue
        if chosen[0].candidate.smooth and not steps[i].evidence.candidate.smooth:
            continue  # a curve stands in where no effect was found, not for one that was
        term = chosen[0].candidate.term
        terms = (*current.terms[:i], term, *current.terms[i + 1 :])
        other = fit(prepared, terms, start=without.shape)
        gains = [without.drive_rms**2 - f.drive_rms**2 for f in (other, current)]
        # an effect beside which a curve is no longer needed is the cause
        named = steps[i].evidence.candidate.smooth and not chosen[0].candidate.smooth
        enough = gains[0] >= _ENOUGH * gains[1]
        better = (other.drive_rms / current.drive_rms) ** 2 < 1.0 - SMALLEST_GAIN
        if better or (named and enough):
            current = other
            steps = [*steps[:i], _step(*chosen, other, ranking, rng), *steps[i + 1 :]]
    return current, steps


def _rank_all(
    prepared: Prepared, current: Fit, rng: np.random.Generator, only: str | None = None
) -> Ranking:
    blocks = make_blocks(current.residual, current.log_index)
    signals = signals_of(prepared, current)
    found = effect_candidates(prepared, signals, current.terms)
    if only:
        found = [c for c in found if c.term.name == only]
        return rank(found, current.free_jacobian, current.residual, current.log_index, blocks, rng)
    found += periodic_candidates(prepared, signals, current.residual, blocks, rng, FLIPS)
    found += smooth_candidates(prepared, signals)
    found += excess_candidates(prepared, current)
    found += wave_candidates(prepared, current.residual, current.log_index, blocks, rng, FLIPS)
    return rank(found, current.free_jacobian, current.residual, current.log_index, blocks, rng)


def _with_refits(prepared: Prepared, current: Fit, ranking: Ranking) -> Ranking:
    """The ranking with the gains of the leading effects as they are after a joint refit.

    Only of those worth naming by what they explain without one, and of those bound up with the
    law: the freedom of a refit lets any effect take what is wrong with the law.
    """
    named = [r for r in ranking.ranked if not r.candidate.smooth]
    leading = [r for r in named if _justified(r) and _large_enough(r, current)][:_SHORTLIST]
    if leading:
        least = _LEAST_OF_LEADER * leading[0].held_out_gain
        leading = [r for r in leading if r.held_out_gain >= least]
    bound = [r for r in named if r.name in _LAW_BOUND and _beyond_chance(r) and r not in leading]
    # An effect is held against the best curves: both as they are after a refit. Hysteresis beside
    # the law's own shows only then.
    curves = [r for r in ranking.ranked if r.candidate.smooth and not r.candidate.within_logs]
    hidden = [r for r in curves if isinstance(r.candidate.term, HysteresisTerm)]
    curves = [r for r in curves if _justified(r) and r not in hidden][:_CURVES] + hidden
    return _replaced(
        ranking, [_refitted(prepared, current, row, ranking) for row in leading + bound + curves]
    )


def _from_everywhere(
    prepared: Prepared, current: Fit, ranking: Ranking, forms: Sequence[Shape]
) -> Ranking:
    """The ranking with the gains of what is bound up with the law as a search from everywhere has
    them: without its effect a law may lie far from where it belongs.
    """
    bound = [r for r in ranking.ranked if r.name in _LAW_BOUND and _beyond_chance(r)]
    return _replaced(ranking, [_refitted(prepared, current, r, ranking, forms) for r in bound])


def _replaced(ranking: Ranking, rows: Sequence[Ranked]) -> Ranking:
    better = {(r.name, r.candidate.kind): r for r in rows}
    ranked = [better.get((r.name, r.candidate.kind), r) for r in ranking.ranked]
    return replace(ranking, ranked=tuple(sorted(ranked, key=lambda r: -r.held_out_gain)))


def _refitted(
    prepared: Prepared,
    current: Fit,
    row: Ranked,
    ranking: Ranking,
    forms: Sequence[Shape] | None = None,
) -> Ranked:
    """A row with its gain after a joint refit, where that is more.

    Args:
        forms: where to search from; None for near the current fit.
    """
    terms = (*current.terms, row.candidate.term)
    if forms:
        refit = fit(prepared, terms, forms=forms)
    else:
        refit = fit(prepared, terms, start=current.shape, closeness=ROUGH)
    # both in units of the drive: where the gain is fitted, an effect may change it
    residual = refit.residual * (current.gain / refit.gain)
    blocks = make_blocks(current.residual, current.log_index)
    squares = held_out_squares(refit.free_jacobian, residual, blocks, row.candidate.within_logs)
    gain = 1.0 - float(squares.sum()) / float(ranking.base_squares.sum())
    if gain > row.held_out_gain:
        row = replace(row, held_out_gain=gain, squares=squares)
    return replace(row, on_edge=_on_edge(refit.terms[-1]))


def _on_edge(term: Term) -> bool:
    """Whether a shape number has come to the end of its physical range."""
    return any(
        min(abs(x - end) for end in limits) <= _EDGE * abs(x)
        for x, limits in zip(term.free_shape, shape_limits(term), strict=True)
    )


def _least_gain(name: str) -> float:
    return _OTHER_GAINS.get(name, SMALLEST_GAIN)


def _justified(row: Ranked) -> bool:
    """By chance, size and form: a law bent with no time or exponent of its own is another law."""
    if row.on_edge and row.name in _LAW_BOUND:
        return False
    return _beyond_chance(row) and row.held_out_gain >= _least_gain(row.name)


def _beyond_chance(row: Ranked) -> bool:
    """By the test, or by half of the residual predicted on folds it was not fitted to.

    What acts in a few blocks only, as an end stop does, cannot pass a test that flips their signs.
    """
    return row.p_value <= SIGNIFICANCE or row.held_out_gain >= _LARGE_GAIN


def _large_enough(row: Ranked, current: Fit) -> bool:
    """Whether an effect moves the torque by a share of the friction worth naming."""
    return _moved(row, current) >= _least_share(row.name)


def _least_share(name: str) -> float:
    return _OTHER_SHARES.get(name, SMALLEST_SHARE)


def _moved(row: Ranked, current: Fit) -> float:
    """Torque that it explains, over the friction's rms."""
    explained = np.sqrt(max(0.0, row.held_out_gain)) * current.rms
    return float(explained / np.sqrt(np.mean(current.friction**2)))


def _choose(
    ranking: Ranking, current: Fit, rng: np.random.Generator
) -> tuple[Ranked, tuple[str, ...]] | None:
    """What to add, and the effects it is tied with.

    The simplest of the effects that the logs cannot tell from the best one, those last that must
    go to the end of their physical range for it. Where a curve without a name explains much more
    than any effect, none is the cause: the curve stands in for it.
    """
    worth = [r for r in ranking.ranked if _justified(r) and _large_enough(r, current)]
    named = [r for r in worth if not r.candidate.smooth]
    if any(isinstance(t, SmoothTerm) for t in current.terms):
        # something without a name is at work, and its by-products look like effects
        named = [r for r in named if r.held_out_gain >= _DOUBT * _least_gain(r.name)]
        named = [r for r in named if _moved(r, current) >= _DOUBT * _least_share(r.name)]
    smooth = [r for r in worth if r.candidate.smooth]
    if smooth and (not named or named[0].held_out_gain < _ENOUGH * smooth[0].held_out_gain):
        return smooth[0], ()
    if not named:
        return None
    best = named[0]
    close = [
        r
        for r in named
        if r.held_out_gain >= (1.0 - _CLOSE) * best.held_out_gain
        and (r is best or _tied(best, r, ranking.base_squares, rng))
    ]
    terms = [r.candidate.term for r in close]
    sizes = [len(t.coefficients) + len(t.shape) for t in terms]
    size = [(r.on_edge, k) for r, k in zip(close, sizes, strict=True)]
    winner = close[size.index(min(size))]
    ties = tuple(
        r.name
        for r, k in zip(close, size, strict=True)
        if r is not winner and k == min(size) and _tied(winner, r, ranking.base_squares, rng)
    )
    return winner, ties


def _tied(winner: Ranked, other: Ranked, base: Array, rng: np.random.Generator) -> bool:
    gap, chance = margin(winner, other, base, rng)
    g = winner.held_out_gain
    return chance or gap < min(_SAME * g, _SAME_LEFT * (1.0 - g))


def _better(prepared: Prepared, terms: tuple[Term, ...], starts: Sequence[Fit]) -> Fit:
    """The better of the fits from some places."""
    return min((fit(prepared, terms, start=s.shape) for s in starts), key=lambda f: f.drive_rms)


def _without_idle(
    prepared: Prepared, steps: list[Step], current: Fit, least: Callable[[str], float], last: bool
) -> tuple[list[Step], Fit]:
    """Drop additions that take less than a least share away beside the others.

    Args:
        least: share of the squares by the name of an effect. last: the last one may go too.
    """
    for i, step in enumerate(steps if last else steps[:-1]):
        terms = tuple(t for k, t in enumerate(current.terms) if k != i)
        without = fit(prepared, terms, start=current.shape, closeness=ROUGH)
        if 1.0 - (current.drive_rms / without.drive_rms) ** 2 < least(step.term.name):
            kept = [s for s in steps if s is not step]
            return _without_idle(
                prepared, kept, fit(prepared, terms, start=without.shape), least, last
            )
    return steps, current


def _unexplained(ranking: Ranking, current: Fit, steps: Sequence[Step]) -> tuple[Ranked, ...]:
    """Curves that still explain something, and those that the loop had to put in for a cause."""
    needed = {(s.evidence.name, s.evidence.candidate.kind) for s in steps}
    best: dict[str, Ranked] = {}
    for r in ranking.ranked:
        asked_for = _justified(r) or (r.name, r.candidate.kind) in needed
        if r.candidate.smooth and asked_for and r.held_out_gain >= SMALLEST_GAIN:
            best.setdefault(r.name, r)
    return tuple(r for r in best.values() if _large_enough(r, current))
