"""Search for effects of the drive: behaviour of a controller that its file does not describe.

A delay or a limit changes the drive by far more than friction, and the change is not proportional
to the parameter, so no linear column predicts the residual. There are few such effects. Each is
fitted from all of its starting values on thinned logs, and the best few on all samples.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.candidate import without_columns
from frictionjoint.diagnose.chance import FLIPS
from frictionjoint.diagnose.library import drive_terms
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.diagnose.physical_bounds import LEAST_ACTING
from frictionjoint.diagnose.score import Scored, scored
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.blocks import halves, make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import first_least, in_order
from frictionjoint.identify.search import CLOSE, ROUGH, Place, Search, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import COARSE, COMPARING_STEPS
from frictionjoint.identify.terms import EffectTerm, Term, all_but, in_place, timed
from frictionjoint.threads import side_by_side

# steps of a fit to thinned logs; effects that are fitted to all samples
_STEPS, _LEADERS = 6, 3

# fraction of the squares that an effect takes, and its term
Ranked = tuple[float, EffectTerm]


class Driven(NamedTuple):
    """Effects of the drive that were tried on a model."""

    look: Look  # all of them, best first
    tried: tuple[tuple[EffectTerm, Scored], ...]  # terms of the leaders with scores, best first
    now: Scored  # of the model without them


def share_left(fitted: Fit) -> float:
    """rms of a model's residual, divided by the rms of the drive in that model."""
    return fitted.drive_rms * fitted.error_unit / fitted.target_rms


def look_at_drive(prepared: Prepared, fitted: Fit, rng: np.random.Generator) -> Driven | None:
    """Try every effect of the drive on a fit; None if the drive is measured, or there is none to
    try.

    The leading ones are fitted to all samples and scored.

    Args:
        prepared: the logs of the fit. rng: for sign flips and halves.
    """
    terms = drive_terms(prepared, fitted.terms)
    if not terms:
        return None
    coarse = prepared.thinned(COARSE)
    start = refit(coarse, fitted.effects, fitted.shape, ROUGH, _STEPS)
    forms = _best_of_each_form(coarse, start, start.effects, terms)
    names = [term.name for _, term in forms]
    order = [pair for k, pair in enumerate(forms) if names[k] not in names[:k]]
    blocks = make_blocks(prepared, fitted)
    now = scored(fitted, blocks)
    tried = []
    for _, term in order[:_LEADERS]:
        own = (*fitted.effects, term)
        found = refit(prepared, own, fitted.shape, ROUGH, COMPARING_STEPS)
        moved = found.effects[-1]
        assert isinstance(moved, EffectTerm)
        if found.acting >= LEAST_ACTING:
            tried.append((moved, scored(found, blocks)))
    if not tried:
        return None
    tried.sort(key=lambda pair: -pair[1].gain(now))
    squares = [score.squares for _, score in tried]
    won = _frequencies(squares, rng)
    rows = [
        Looked(
            without_columns(term),
            left,
            min(1.0, len(order) * sign_flips(now.squares - left, rng)),
            frequency,
        )
        for (term, _), left, frequency in zip(tried, squares, won, strict=True)
    ]
    rows += [
        Looked(without_columns(term), (1.0 - gain) * now.squares, 1.0, 0.0)
        for gain, term in order[_LEADERS:]
    ]
    return Driven(Look(tuple(rows), now.squares, 0.0), tuple(tried), now)


def others_of_drive(prepared: Prepared, fitted: Fit, i: int) -> list[Fit]:
    """Models with another effect of the drive, or another form, in place of the i-th effect.

    Other forms come first, in the order of the catalogue, then the best other effects. The rest of
    the model is kept as fitted with the i-th effect, because a refit without it would be biased.
    """
    own = fitted.effects
    terms = drive_terms(prepared, all_but(own, own[i]))
    coarse = prepared.thinned(COARSE)
    start = refit(coarse, own, fitted.shape, ROUGH, _STEPS)
    best = _best_of_each_form(coarse, start, all_but(start.effects, start.effects[i]), terms)
    forms = [term for _, term in best if term.name == own[i].name]
    forms.sort(key=lambda term: DRIVE_EFFECTS.index(term.effect))
    others = [term for _, term in best if term.name != own[i].name]
    # forms differ by less than effects do: compare them by all that each can explain
    found = [(term, CLOSE) for term in forms]
    found += [(term, ROUGH) for term in others[: _LEADERS - 1]]
    return [
        refit(prepared, in_place(own, i, term), fitted.shape, closeness, COMPARING_STEPS)
        for term, closeness in found
    ]


def _best_of_each_form(
    coarse: Prepared, start: Fit, others: tuple[Term, ...], terms: Sequence[EffectTerm]
) -> list[Ranked]:
    """For each form of an effect, the size with the smallest residual on thinned logs, best first.

    Each comes with the reduction of the squared residual, as a fraction of the squared drive.
    """

    def begun(term: EffectTerm) -> Place:
        search = Search(coarse, timed(coarse, (*others, term), start.shape), start.shape)
        return Place(0.5 * search.squares(search.start), search, search.start)

    def attempt(place: Place) -> Fit:
        return place.search.result(place.search.run(place.x, _STEPS, ROUGH).x)

    with side_by_side() as each:
        places = list(zip(terms, each(begun, terms), strict=True))
        # the best start of each form
        starts: dict[Effect, Place] = {}
        for term, place in in_order(places, lambda pair: pair[1].cost):
            starts.setdefault(term.effect, place)
        fits = list(each(attempt, list(starts.values())))
    best: list[Ranked] = []
    for found in fits:
        term = found.effects[-1]
        assert isinstance(term, EffectTerm)
        if found.acting >= LEAST_ACTING:  # a drive of nothing explains nothing
            best.append((1.0 - (found.drive_rms / start.drive_rms) ** 2, term))
    return in_order(best, lambda pair: 1.0 - pair[0])


def sign_flips(difference: Array, rng: np.random.Generator) -> float:
    """Probability of as large a gain if the sign of each block's gain were random."""
    flips = rng.choice([-1.0, 1.0], size=(FLIPS, len(difference))) @ difference
    return float((1 + np.sum(flips >= difference.sum())) / (FLIPS + 1))


def _frequencies(squares: Sequence[Array], rng: np.random.Generator) -> list[float]:
    """Fraction of random halves of the blocks on which each effect is the best."""
    half = halves(len(squares[0]), rng)
    first = first_least(np.array(squares) @ half.T)
    return [float(x) for x in np.bincount(first, minlength=len(squares)) / len(half)]
