"""Every candidate against a residual, the leading ones after a joint refit."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.candidates import (
    effect_candidates,
    excess_candidates,
    periodic_candidates,
    signals_of,
    smooth_candidates,
    wave_candidates,
)
from frictionjoint.diagnose.choice import ENOUGH, LAW_BOUND, beyond_chance, justified, worth_naming
from frictionjoint.diagnose.trace import FLIPS, Ranked, Ranking, held_out_squares, rank
from frictionjoint.identify.fit import ROUGH, Fit, fit, shape_limits
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import HysteresisTerm
from frictionjoint.identify.terms import Term

# How many of the leading effects are compared after a joint refit, and the share of the leader's
# gain they need before it: an effect bound up with the law shows its whole gain only then.
_SHORTLIST, _CURVES, _LEAST_OF_LEADER = 4, 2, 0.15
# nearness to the end of a physical range, over the number itself
_EDGE = 0.02


def rank_all(
    prepared: Prepared, current: Fit, rng: np.random.Generator, only: str | None = None
) -> Ranking:
    """Effects, waves in position and time, curves and a limit of the drive, best first.

    Args:
        only: name of the one effect to try; None for everything.
    """
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


def barring(ranking: Ranking, names: Collection[str]) -> Ranking:
    """The ranking without the effects of these names."""
    left = tuple(r for r in ranking.ranked if r.candidate.smooth or r.name not in names)
    return replace(ranking, ranked=left)


def with_refits(prepared: Prepared, current: Fit, ranking: Ranking) -> Ranking:
    """The ranking with the gains of the leading effects as they are after a joint refit.

    Only of those worth naming by what they explain without one, and of those bound up with the
    law: the freedom of a refit lets any effect take what is wrong with the law.
    """
    named = [r for r in ranking.ranked if not r.candidate.smooth]
    leading = [r for r in named if worth_naming(r, current)][:_SHORTLIST]
    if leading:
        least = _LEAST_OF_LEADER * leading[0].held_out_gain
        leading = [r for r in leading if r.held_out_gain >= least]
    bound = [r for r in named if r.name in LAW_BOUND and beyond_chance(r) and r not in leading]
    # An effect is held against the best curves: both as they are after a refit. Hysteresis beside
    # the law's own shows only then.
    curves = [r for r in ranking.ranked if r.candidate.smooth and not r.candidate.within_logs]
    hidden = [r for r in curves if isinstance(r.candidate.term, HysteresisTerm)]
    curves = [r for r in curves if justified(r) and r not in hidden][:_CURVES] + hidden
    return _refitted(prepared, current, ranking, leading + bound + curves, current.shape)


def beside_unbent(
    prepared: Prepared, current: Fit, ranking: Ranking, curve: Ranked
) -> tuple[Ranking, Shape]:
    """The ranking with the gains that what is bound up with the law has beside an unbent one.

    A law that has bent to such an effect lies far from where it belongs, and hides the effect from
    a test beside it. A curve lets the law go back. One in the velocity that is beyond chance
    vouches for an effect that explains as much.

    Args:
        curve: that would be added.
    Returns:
        the ranking, and the law as it is beside the curve.
    """
    terms = (*current.terms, curve.candidate.term)
    unbent = fit(prepared, terms, start=current.shape, closeness=ROUGH).shape
    bound = [r for r in ranking.ranked if r.name in LAW_BOUND]
    if curve.name != "velocity":
        bound = [r for r in bound if beyond_chance(r)]
    refitted = _refitted(prepared, current, ranking, bound, unbent)
    tried = {r.name for r in bound}
    vouched = tuple(
        replace(r, p_value=min(r.p_value, curve.p_value))
        if r.name in tried and r.held_out_gain >= ENOUGH * curve.held_out_gain
        else r
        for r in refitted.ranked
    )
    return replace(refitted, ranked=vouched), unbent


def _refitted(
    prepared: Prepared, current: Fit, ranking: Ranking, rows: Sequence[Ranked], start: Shape
) -> Ranking:
    """The ranking with the gains of some rows after a joint refit, where those are more.

    Args:
        start: law to start from.
    """
    blocks = make_blocks(current.residual, current.log_index)
    base = float(ranking.base_squares.sum())
    found: dict[tuple[str, str], Ranked] = {}
    for row in rows:
        terms = (*current.terms, row.candidate.term)
        refit = fit(prepared, terms, start=start, closeness=ROUGH)
        # both in units of the drive: where the gain is fitted, an effect may change it
        residual = refit.residual * (current.gain / refit.gain)
        within = row.candidate.within_logs
        squares = held_out_squares(refit.free_jacobian, residual, blocks, within)
        gain = 1.0 - float(squares.sum()) / base
        row = replace(row, on_edge=at_an_end(refit.terms[-1]))
        if gain > row.held_out_gain:
            row = replace(row, held_out_gain=gain, squares=squares)
        found[row.name, row.candidate.kind] = row
    ranked = [found.get((r.name, r.candidate.kind), r) for r in ranking.ranked]
    return replace(ranking, ranked=tuple(sorted(ranked, key=lambda r: -r.held_out_gain)))


def at_an_end(term: Term) -> bool:
    """Whether a shape number has come to the end of its physical range."""
    return any(
        min(abs(x - end) for end in limits) <= _EDGE * abs(x)
        for x, limits in zip(term.free_shape, shape_limits(term), strict=True)
    )
