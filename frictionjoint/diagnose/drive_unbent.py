"""Effects of the drive that a biased friction law hides.

A law fitted without an effect of the drive is biased, and with that law the effect may seem to
explain nothing: a wide hysteresis imitates a dead band. So before the search ends, each effect is
tried with the unbiased starting values of a law. An effect that leaves a much smaller residual
there than the model with its fitted law is then fitted jointly with the model's own law, from all
starts.
"""

import numpy as np

from frictionjoint.decisions import SMALLEST_GAIN
from frictionjoint.diagnose.drive import Driven, Ranked, judged
from frictionjoint.diagnose.library import drive_terms
from frictionjoint.diagnose.other_laws import forms_like
from frictionjoint.diagnose.unbent import unbent
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rival_shape import prompt_maxwell_slip
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import COARSE, ripened, screened_starts
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.threads import side_by_side


def look_at_hidden_drive(
    prepared: Prepared, fitted: Fit, rng: np.random.Generator
) -> Driven | None:
    """Effects of the drive tried with unbiased laws; None if none reduces the residual.

    Args:
        prepared: the logs of the fit. rng: for sign flips and halves.
    """
    forms = _promising(prepared, fitted)
    if not forms:
        return None
    own = [forms_like(fitted.shape)]

    def added(term: EffectTerm) -> Fit:
        return unbent(prepared, (*fitted.effects, term), own)

    anew = unbent(prepared, fitted.effects, own)
    return judged(prepared, best_of([fitted, anew], lambda f: f.drive_rms), forms, added, rng)


def _promising(prepared: Prepared, fitted: Fit) -> list[Ranked]:
    """For each form of an effect, the size with the smallest residual at a law's starting values.

    The best is first. Each comes with the reduction of the residual relative to the model with the
    best fit of that law. That law is one with few starting values, and can differ from the law of
    the model.
    """
    terms = drive_terms(prepared, fitted.effects)
    coarse, law = prepared.thinned(COARSE), prompt_maxwell_slip()
    if not terms:
        return []
    alone = ripened(coarse, fitted.effects, law)[0].cost

    def left(term: EffectTerm) -> float:
        return screened_starts(coarse, (*fitted.effects, term), law)[0].cost

    with side_by_side() as each:
        gains = [1.0 - cost / alone for cost in each(left, terms)]
    best: dict[Effect, Ranked] = {}
    for gain, term in zip(gains, terms, strict=True):
        if gain >= max(SMALLEST_GAIN, best.get(term.effect, (0.0,))[0]):
            best[term.effect] = gain, term
    return in_order(list(best.values()), lambda pair: 1.0 - pair[0])
