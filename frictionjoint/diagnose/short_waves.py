"""Waves in position that are not much longer than the travel."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.decisions import APART
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.gram import screen
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import FEWEST_WAVES
from frictionjoint.identify.segment import Prepared


def short_waves(prepared: Prepared, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that are waves with less than one and a half periods in the usual travel."""
    fewest = 2.0 * np.pi * FEWEST_WAVES / prepared.usual_travel
    return [c for c in candidates if c.term.effect.is_wave and c.term.shape[0] < fewest]


def waves_like_curves(
    fitted: Fit, blocks: Blocks, short: Sequence[Candidate], curves: Sequence[Candidate]
) -> list[Candidate]:
    """Short waves without half of the error of every free curve on unlike motion.

    Short waves resemble any curve. But where a fold of the logs has no positions a wave continues,
    and a curve does not.
    """
    seen = screen(fitted, blocks, [*short, *curves])
    left = [float(seen.held_out([*seen.terms, at])[0].sum()) for at in seen.candidates]
    most = (1.0 - APART) ** 2 * min(left[len(short) :], default=np.inf)
    return [c for c, its in zip(short, left, strict=False) if its > most]
