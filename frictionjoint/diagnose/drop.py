"""Backward elimination of effects whose removal does not worsen held-out prediction."""

from functools import partial

from frictionjoint.diagnose.candidate import is_unnamed, named_of
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, is_small, needed, with_fewer
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.terms import all_but
from frictionjoint.identify.weights import reweighed
from frictionjoint.threads import side_by_side


def drop_idle(state: State) -> None:
    """Remove, one after the other, effects whose removal does not worsen held-out prediction.

    Unnamed dependences adapt to the data and are no causes, so each effect is judged among named
    effects alone. Small losses do not accumulate: if either of two effects can be removed but not
    both, one stays.
    """
    first = named_of(state.fit.effects)
    while state.fit.effects:
        own = state.fit.effects
        causes = named_of(own)
        beside = [own if is_unnamed(t) else causes for t in own]
        fewer = [all_but(terms, t) for terms, t in zip(beside, own, strict=True)]
        models = [terms for terms in dict.fromkeys([first, *beside, *fewer]) if terms != own]
        refitted = partial(with_fewer, state)
        with side_by_side() as each:
            fits = dict(zip(models, each(refitted, models), strict=True)) | {own: state.fit}
        ways = [{m: scored(f, blocks) for m, f in fits.items()} for blocks in state.either_way]
        idle = []
        for t, terms, rest in zip(own, beside, fewer, strict=True):
            whole = {terms} if is_unnamed(t) else {terms, first}
            pairs = [(way[x], way[rest]) for x in whole for way in ways]
            if not any(needed(*p, t.effect.first) and not is_small(t, *p) for p in pairs):
                idle.append((max(way[terms].gain(way[rest]) for way in ways), t))
        if not idle:
            return
        # of those that are idle alike the one that came last
        rest = all_but(own, best_of(idle[::-1], lambda x: max(x[0], 0.0))[1])
        found = fits.get(rest) or refitted(rest)
        state.prepared, state.fit = reweighed(state.prepared, found)
