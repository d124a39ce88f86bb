"""All candidates next to a model without one of its effects."""

from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.candidate import is_unnamed
from frictionjoint.diagnose.library import waves_in_position
from frictionjoint.diagnose.moves import Look, look
from frictionjoint.diagnose.short_waves import short_waves
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
