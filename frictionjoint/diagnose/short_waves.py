"""Waves in position that are hardly longer than the travel."""

import numpy as np

from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.decisions import APART
from frictionjoint.diagnose.gram import screen
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import FEWEST_WAVES
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm, Term


def without_curves(
    prepared: Prepared,
    fitted: Fit,
    blocks: Blocks,
    candidates: list[Candidate],
    curves: list[Candidate],
) -> list[Candidate]:
    """Candidates without short waves, but for those with half of the error of every free curve.

    Less than one and a half waves in position resemble any curve. But where a fold of the logs has
    no positions a wave continues, and a curve does not.
    """
    fewest = 2.0 * np.pi * FEWEST_WAVES / prepared.usual_travel
    short = [c for c in candidates if _is_wave(c.term) and c.term.shape[0] < fewest]
    if not short:
        return candidates
    seen = screen(fitted, blocks, [*short, *curves])
    left = [float(seen.held_out([*seen.terms, at])[0].sum()) for at in seen.candidates]
    most = (1.0 - APART) ** 2 * min(left[len(short) :], default=np.inf)
    curved = {id(c) for c, its in zip(short, left, strict=False) if its > most}
    return [c for c in candidates if id(c) not in curved]


def _is_wave(term: Term) -> bool:
    return isinstance(term, EffectTerm) and term.effect.proposed_by == "spectrum"
