"""Additions looked at again beside those that came after: exchanged, replaced or dropped."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from frictionjoint.diagnose.choice import ENOUGH, SAME, SMALLEST_GAIN, Choice, choose, numbers_of
from frictionjoint.diagnose.ranking import rank_all, with_refits
from frictionjoint.diagnose.step import Step, step_of
from frictionjoint.diagnose.trace import Ranked
from frictionjoint.identify.fit import ROUGH, Fit, fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.smooth import SmoothTerm

# error of a fit over that of another, both without their curves, beyond which it leans on them
_LEANS = 2.0

T = TypeVar("T")


def exchanged(
    prepared: Prepared, current: Fit, steps: list[Step], gain: float, rng: np.random.Generator
) -> tuple[Fit, list[Step]] | None:
    """An early choice given up for a rival that explains nearly as much as an addition would.

    What the logs could not tell apart beside a large residual they may tell beside a small one.

    Args:
        gain: of the addition, a share of the residual's squares.
    """
    names = {t.name for t in current.terms}
    trials: list[tuple[Fit, int, Ranked]] = []
    for i, step in enumerate(steps):
        for rival in step.rivals:
            if rival.name not in names:
                terms = _with(current.terms, i, rival.candidate.term)
                other = fit(prepared, terms, start=current.shape, closeness=ROUGH)
                trials.append((other, i, rival))
    if not trials:
        return None
    best, i, rival = min(trials, key=lambda trial: trial[0].drive_rms)
    if 1.0 - (best.drive_rms / current.drive_rms) ** 2 < ENOUGH * gain:
        return None
    current = fit(prepared, best.terms, start=best.shape)
    others = tuple(r for r in steps[i].rivals if r is not rival)
    choice = Choice(rival, rivals=(steps[i].evidence, *others))
    step = step_of(choice, current, steps[i].ranking, rng)
    return current, list(_with(steps, i, step))


def reconsidered(
    prepared: Prepared, current: Fit, steps: list[Step], first: int, rng: np.random.Generator
) -> tuple[Fit, list[Step]]:
    """The first choices once more, beside those that came after.

    A better one replaces each, or one as good and simpler.
    """
    for i in range(first):
        rest = _without(current.terms, i)
        without = fit(prepared, rest, start=current.shape, closeness=ROUGH)
        ranking = rank_all(prepared, without, rng)
        if steps[i].evidence.candidate.smooth:
            # what a curve stands in for is asked as it was when the curve was taken
            ranking = with_refits(prepared, without, ranking)
        chosen = choose(ranking, without, rng)
        if chosen is None or chosen.winner.name == steps[i].term.name:
            continue
        if chosen.winner.candidate.smooth and not steps[i].evidence.candidate.smooth:
            continue  # a curve stands in where no effect was found, not for one that was
        term = chosen.winner.candidate.term
        other = fit(prepared, _with(current.terms, i, term), start=without.shape)
        gains = [without.drive_rms**2 - f.drive_rms**2 for f in (other, current)]
        # an effect beside which a curve is no longer needed is the cause
        named = steps[i].evidence.candidate.smooth and not chosen.winner.candidate.smooth
        enough = gains[0] >= ENOUGH * gains[1]
        better = (other.drive_rms / current.drive_rms) ** 2 < 1.0 - SMALLEST_GAIN
        # beside what is simpler another effect may have nothing left to explain
        simpler = numbers_of(term) < numbers_of(steps[i].term)
        as_good = gains[0] >= (1.0 - SAME) * gains[1]
        if (
            better
            or (named and enough)
            or (simpler and as_good and not _leans(prepared, other, current))
        ):
            current = other
            steps = list(_with(steps, i, step_of(chosen, other, ranking, rng)))
    return current, steps


def _leans(prepared: Prepared, other: Fit, current: Fit) -> bool:
    """Whether one fit is as good as the other only for the curves in both.

    A curve in the position takes what gravity does there, and beside it a bias is as good.
    """
    if not any(isinstance(t, SmoothTerm) for t in current.terms):
        return False
    alone = []
    for whole in (other, current):
        terms = tuple(t for t in whole.terms if not isinstance(t, SmoothTerm))
        alone.append(fit(prepared, terms, start=whole.shape, closeness=ROUGH).drive_rms)
    return alone[0] > _LEANS * alone[1]


def without_idle(
    prepared: Prepared, steps: list[Step], current: Fit, least: Callable[[str], float], last: bool
) -> tuple[list[Step], Fit]:
    """Drop additions that take less than a least share away beside the others.

    Args:
        least: share of the squares by the name of an effect. last: the last one may go too.
    """
    for i, step in enumerate(steps if last else steps[:-1]):
        terms = _without(current.terms, i)
        without = fit(prepared, terms, start=current.shape, closeness=ROUGH)
        if 1.0 - (current.drive_rms / without.drive_rms) ** 2 < least(step.term.name):
            kept = [s for s in steps if s is not step]
            return without_idle(
                prepared, kept, fit(prepared, terms, start=without.shape), least, last
            )
    return steps, current


def _with(items: Sequence[T], i: int, item: T) -> tuple[T, ...]:
    return (*items[:i], item, *items[i + 1 :])


def _without(items: Sequence[T], i: int) -> tuple[T, ...]:
    return (*items[:i], *items[i + 1 :])
