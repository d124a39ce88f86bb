"""What a search says in the end."""

from collections.abc import Sequence
from dataclasses import replace

from frictionjoint.diagnose.drop import drop_idle
from frictionjoint.diagnose.finding import Finding, Trace, sight
from frictionjoint.diagnose.library import is_unnamed
from frictionjoint.diagnose.nearest import Replayed, drop_what_moves_worse, moving_nearest
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, without
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.result import units_of
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import reweighed


def told(state: State, base: Fit, replayed: Replayed, law_by_motion: bool) -> Trace:
    """What was found, without the dependences that have no name: those are only reported."""
    unexplained: dict[str, float] = {}
    hints: list[str] = []
    blocks = state.blocks
    whole = scored(state.fit, blocks)
    for i, term in enumerate(state.fit.terms):
        if isinstance(term, SmoothTerm):
            gain = whole.gain(scored(without(state, term), blocks))
            unexplained[term.name] = max(gain, unexplained.get(term.name, 0.0))
            if not state.prepared.gain_unknown:
                unit, _ = units_of(state.fit, state.prepared.slide)
                hints.append(term.says(state.fit.term_coefficients(i), unit))
    if unexplained:
        named = tuple(t for t in state.fit.effects if not is_unnamed(t))
        state.prepared = _with_torque_that_acted(state)
        alone = refit(state.prepared, named, state.fit.shape)
        state.prepared, state.fit = reweighed(state.prepared, alone)
        drop_idle(state)
    state.prepared, state.fit = reweighed(*settled(state.prepared, state.fit))
    if law_by_motion and moving_nearest(state, replayed):
        drop_idle(state)
    drop_what_moves_worse(state, base, replayed)
    found: list[Finding] = []
    for term in state.fit.effects:
        own = [f for f in state.findings if f.term.name == term.name]
        found.append(replace(own[min(len(found_of(found, term)), len(own) - 1)], term=term))
    other = state.laws.unchosen(state.prepared, state.fit, base)
    same = not state.fit.effects and state.fit.shape.variables == base.shape.variables
    base = state.fit if same else refit(state.prepared, (), base.shape)
    return Trace(
        prepared=state.prepared,
        base=base,
        findings=tuple(found),
        final=state.fit,
        unexplained=tuple(sorted(unexplained.items(), key=lambda x: -x[1])),
        hints=tuple(filter(None, hints)),
        last_look=state.look,
        other=other,
        sight=sight(state.prepared, state.fit, state.look),
    )


def _with_torque_that_acted(state: State) -> Prepared:
    """The logs without what a dependence on their own torque says did not act."""
    logs = list(state.prepared.segments)
    for i, term in enumerate(state.fit.terms):
        if isinstance(term, ExcessTerm):
            (fraction,) = state.fit.term_coefficients(i)
            logs = [term.corrected(s, float(fraction)) for s in logs]
    return replace(state.prepared, segments=tuple(logs))


def found_of(found: Sequence[Finding], term: Term) -> list[Finding]:
    """Findings of one name: harmonics of a periodic effect come one by one."""
    return [f for f in found if f.term.name == term.name]
