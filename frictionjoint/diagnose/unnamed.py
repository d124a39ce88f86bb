"""Quantities on which the residual may depend equally well, because the logs couple them.

In an arm that moves alone the load is a function of position, and no log distinguishes them.
"""

from frictionjoint.decisions import TIE
from frictionjoint.diagnose.exchange import best_first
from frictionjoint.diagnose.moves import ALTERNATIVES
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, compared, distinguishable
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.smooth import SplineTerm
from frictionjoint.identify.terms import Term, in_place


def quantities_alike(state: State, blocks: Blocks, i: int) -> dict[str, float]:
    """Quantities that explain as much as the quantity of the i-th effect, which is a curve.

    Returns:
        the quantities, and the fraction of the residual that each explains.
    """
    own = state.fit.effects
    term = own[i]
    if not isinstance(term, SplineTerm):
        return {}
    taken = {t.name for t in own}
    others = [
        c for c in state.candidates if isinstance(c.term, SplineTerm) and c.term.name not in taken
    ]
    if not others:
        return {}
    best: dict[str, Term] = {}
    for candidate in best_first(state, blocks, i, others):
        best.setdefault(candidate.term.name, candidate.term)
    now = scored(state.fit, blocks)
    rest = tuple(t for t in own if t is not term)
    bare = scored(compared(state.prepared, rest, state.fit.shape), blocks)
    found = {}
    for instead in list(best.values())[:ALTERNATIVES]:
        terms = in_place(own, i, instead)
        other = scored(compared(state.prepared, terms, state.fit.shape), blocks)
        # a difference that a few blocks carry is not significant, however large
        alike = other.gain(bare) >= (1.0 - TIE) * now.gain(bare)
        if alike and not distinguishable(now, other):
            found[instead.name] = other.gain(bare)
    return found
