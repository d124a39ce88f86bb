"""Backward elimination of effects whose removal does not worsen held-out prediction."""

from functools import partial

from frictionjoint.decisions import APART
from frictionjoint.diagnose.candidate import is_unnamed
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, improves, is_small, with_fewer
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.smooth import EncoderTerm
from frictionjoint.identify.terms import Term, all_but
from frictionjoint.identify.weights import reweighed
from frictionjoint.threads import side_by_side


def drop_redundant(state: State) -> None:
    """Remove, one after the other, effects whose removal does not worsen held-out prediction.

    Curves adapt to any data, so each effect is judged in a model without them; in addition next to
    them, if it removes there at most twice as much: a curve may stand for a larger effect. An
    eccentric encoder counts as an effect, not as a curve. If either of two effects can be removed
    but not both, one stays.
    """
    state.forget_dropped()
    first = tuple(filter(_is_cause, state.fit.effects))
    while state.fit.effects:
        own = state.fit.effects
        causes = tuple(filter(_is_cause, own))
        beside = [causes if _is_cause(t) else own for t in own]
        fewer = [all_but(terms, t) for terms, t in zip(beside, own, strict=True)]
        without = [all_but(own, t) for t in own]
        models = dict.fromkeys([first, *beside, *fewer, *without])
        refitted = partial(with_fewer, state)
        with side_by_side() as each:
            others = [terms for terms in models if terms != own]
            fits = dict(zip(others, each(refitted, others), strict=True)) | {own: state.fit}
        ways = [{m: scored(f, blocks) for m, f in fits.items()} for blocks in state.either_way]
        idle = []
        for t, terms, rest, bare in zip(own, beside, fewer, without, strict=True):
            whole = {terms, first} if _is_cause(t) else {terms}
            pairs = [(way[x], way[rest]) for x in whole for way in ways]
            for way in ways:
                removed = way[bare].total - way[own].total
                if way[rest].total - way[terms].total >= APART * removed:
                    pairs.append((way[own], way[bare]))
            if not any(improves(*p, t.effect.first) and not is_small(t, *p) for p in pairs):
                idle.append((max(way[terms].gain(way[rest]) for way in ways), t))
        if not idle:
            return
        # among equally redundant effects, the one that was added last
        least = best_of(idle[::-1], lambda x: max(x[0], 0.0))[1]
        state.left_out[least.name] = "the model predicts as much without it"
        rest = all_but(own, least)
        found = fits.get(rest) or refitted(rest)
        state.prepared, state.fit = reweighed(state.prepared, found)
        state.forget_dropped()


def _is_cause(term: Term) -> bool:
    return isinstance(term, EncoderTerm) or not is_unnamed(term)
