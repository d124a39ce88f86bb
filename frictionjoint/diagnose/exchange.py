"""Exchanges within a model: another form of an effect, another effect in its place."""

from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.blocks import Blocks, make_blocks
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.library import Candidate, is_unnamed, library, other_forms
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, apart, as_much, compared, numbers_of
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import reweighed


def best_forms(state: State) -> bool:
    """Give each effect the form that predicts best: the first look saw them beside a bent law.

    Returns:
        whether any has another form now: what stood in for that may be idle.
    """
    before = state.fit
    for i in range(len(state.fit.effects)):
        others = other_forms(state.prepared, state.fit, state.fit.effects[i])
        if not others:
            continue
        blocks = make_blocks(state.prepared, state.fit)
        other = _in_place_of(state, blocks, i, others)[1]
        if scored(other, blocks).better(scored(state.fit, blocks)):
            state.prepared, state.fit = reweighed(state.prepared, other)
    return state.fit is not before


def weigh_others(state: State) -> None:
    """Exchange each effect for the best other one of no more numbers, beside all others.

    A simpler one that explains as much stays; one as simple is a tie.
    """
    for i in range(len(state.fit.effects)):
        own, blocks = state.fit.effects, make_blocks(state.prepared, state.fit)
        looks = [f.look for f in state.findings if f.term.name == own[i].name]
        others = [
            c
            for c in library(state.prepared, state.fit, blocks)
            if not c.unnamed and numbers_of(c.term) <= numbers_of(own[i])
            if all(look.holds(c) for look in looks)
        ]
        if not others or is_unnamed(own[i]):
            continue
        best, other = _in_place_of(state, blocks, i, others)
        now, instead = scored(state.fit, blocks), scored(other, blocks)
        if numbers_of(best.term) < numbers_of(own[i]) and as_much(instead, now):
            state.findings = [_instead(f, own[i], best) for f in state.findings]
            state.prepared, state.fit = reweighed(state.prepared, other)
        elif not apart(now, instead):
            state.findings = [_tied(f, own[i], best) for f in state.findings]


def _tied(finding: Finding, term: Term, candidate: Candidate) -> Finding:
    """A finding of an effect, with one that explains as much."""
    if finding.term.name != term.name or candidate.term.name in finding.ties:
        return finding
    return replace(finding, ties=(*finding.ties, candidate.term.name))


def _instead(finding: Finding, term: Term, candidate: Candidate) -> Finding:
    """A finding of one effect as that of a simpler one, seen in the same look."""
    if finding.term.name != term.name:
        return finding
    row = finding.look.find(candidate)
    ties = tuple(name for name in finding.ties if name != row.name)
    return replace(finding, term=candidate.term, row=row, ties=ties)


def _in_place_of(
    state: State, blocks: Blocks, i: int, others: list[Candidate]
) -> tuple[Candidate, Fit]:
    """The candidate that promises most in place of the i-th effect, and the model with it."""
    seen = screen(state.fit, blocks, others)
    rest = [at for k, at in enumerate(seen.terms) if k != i]
    left = [float(seen.held_out([*rest, at])[0].sum()) for at in seen.candidates]
    best = others[int(np.argmin(left))]
    own = state.fit.effects
    terms: tuple[Term, ...] = (*own[:i], best.term, *own[i + 1 :])
    return best, compared(state.prepared, terms, state.fit.shape)
