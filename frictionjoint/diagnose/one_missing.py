"""Candidates next to a model without one of its effects; named effects in place of unnamed ones.

While a law is biased by a missing effect, a curve of a measured quantity may explain more of the
residual than the effect: a wave has one frequency, and the spectrum of the residual shows another.
The law that is fitted together with the curve is nearly unbiased, so the effects are screened again
with that law, as if only the curve were missing.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.decisions import SIGNIFICANCE
from frictionjoint.diagnose.candidate import is_unnamed
from frictionjoint.diagnose.choice import Tried, may_gain
from frictionjoint.diagnose.library import waves_in_position
from frictionjoint.diagnose.moves import ALTERNATIVES, Look, Move, look
from frictionjoint.diagnose.spectrum import short_waves
from frictionjoint.diagnose.state import State
from frictionjoint.identify.search import Search
from frictionjoint.identify.terms import Term, all_but


def candidates_without(state: State, term: Term, rng: np.random.Generator) -> tuple[State, Look]:
    """The state without one effect, and its candidates, as if only this effect were missing.

    The law and the shapes of the other effects stay as they are. Time offsets stay too: an offset
    freed by another fit could imitate the removed inertia. In place of a wave or a curve, short
    waves are candidates even where they resemble a curve.
    """
    found = Search(state.prepared, all_but(state.fit.terms, term), state.fit.shape)
    bare = replace(state, fit=found.result(found.start))
    candidates = bare.candidates
    if is_unnamed(term) or term.effect.is_wave:
        waves = waves_in_position(bare.prepared, bare.fit, bare.blocks)
        candidates = [*candidates, *short_waves(bare.prepared, waves)]
    seen, _ = look(bare.fit, bare.blocks, candidates, rng)
    return bare, seen


def named_instead(state: State, move: Move, rng: np.random.Generator) -> list[Move]:
    """The most promising changes with a named effect in place of each unnamed dependence.

    Short waves are judged only when they are refitted, see `better_than_curve`.

    Args:
        state: after `move`, with its unnamed dependences and with the law fitted together with
            them.
    """
    found: list[Move] = []
    for term in filter(is_unnamed, state.fit.effects):
        others = tuple(c for c in move.added if not c.unnamed or c.term.name != term.name)
        bare, seen = candidates_without(state, term, rng)
        named = [r for r in seen.rows if not r.candidate.unnamed and r.p_value <= SIGNIFICANCE]
        instead = [
            Move((*bare.fit.effects, r.candidate.term), (*others, r.candidate), r.left, seen)
            for r in named[:ALTERNATIVES]
        ]
        found += filter(may_gain, instead)
    return found


def better_than_curve(instead: Sequence[Tried], curve: Tried) -> list[Tried]:
    """Refitted changes without short waves that do not predict better than the curve.

    Any smooth dependence resembles a part of a wave. But a curve has more numbers, so it follows
    what is no wave more closely than the wave that is nearest to it.
    """
    return [
        t
        for t in instead
        if t.score.better(curve.score) or not short_waves(t.prepared, t.move.added)
    ]
