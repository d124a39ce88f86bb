"""Exchanges within a model: another form of an effect, or another effect in its place."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from frictionjoint.diagnose.candidate import Candidate, is_unnamed
from frictionjoint.diagnose.determined import position_is_open
from frictionjoint.diagnose.drive import others_of_drive
from frictionjoint.diagnose.finding import Finding, finding_of
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.library import other_forms
from frictionjoint.diagnose.moves import ALTERNATIVES, Look, look
from frictionjoint.diagnose.score import Scored, scored
from frictionjoint.diagnose.state import (
    State,
    as_good,
    compared,
    distinguishable,
    improves,
    is_small,
    numbers_of,
    size_of,
    without,
)
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import in_order
from frictionjoint.identify.search import refit
from frictionjoint.identify.terms import DriveTerm, Term, all_but, in_place
from frictionjoint.identify.weights import reweighed


def best_forms(state: State) -> bool:
    """Give each effect the form that predicts best, because the first screening used a biased law.

    Among forms that predict equally well, and where the logs do not determine a position of the
    richer form, the simplest form is used.

    Returns:
        whether a form changed. Then an effect that compensated for the wrong form may be redundant.
    """
    before = state.fit
    for i in range(len(state.fit.effects)):
        others = other_forms(state.prepared, state.fit, state.fit.effects[i])
        for simpler in (False, True):
            if simpler:
                most = numbers_of(state.fit.effects[i])
                others = [c for c in others if numbers_of(c.term) < most]
            if not others:
                break
            blocks = state.blocks
            now = scored(state.fit, blocks)
            other = scored(_in_place_of(state, blocks, i, others)[1], blocks)
            if simpler:
                open_end = as_good(other, now) and position_is_open(state.prepared, state.fit, i)
                taken = open_end or not now.better(other)
            else:
                taken = other.better(now)
            if taken:
                state.prepared, state.fit = reweighed(state.prepared, other.fit)
    return state.fit is not before


def try_other_effects(state: State) -> None:
    """Try the best other effect with no more parameters in place of each effect.

    A simpler effect that explains as much replaces it, unless the model is as good without both. An
    equally simple one is a tie; the first in the catalogue is named, unless one of them explains
    much more when the other effects are left out, which could compensate.
    """
    # together with a curve, which adapts to any data, an effect may seem as good as another
    if any(map(is_unnamed, state.fit.effects)):
        return
    for i in range(len(state.fit.effects)):
        own, blocks = state.fit.effects, state.blocks
        most = numbers_of(own[i])
        others = [c for c in _alternatives(state, own[i]) if numbers_of(c.term) <= most]
        if not others:
            continue
        best, other = _in_place_of(state, blocks, i, others)
        now, instead = scored(state.fit, blocks), scored(other, blocks)
        simpler = numbers_of(best.term) < most and as_good(instead, now)
        if simpler and improves(instead, scored(without(state, own[i]), blocks)):
            _exchange(state, own[i], best.term, other)
        elif not distinguishable(now, instead):
            names = [effect.name for effect in (*CATALOGUE, *DRIVE_EFFECTS)]
            first = names.index(best.term.name) < names.index(own[i].name)
            first = first and not now.better(instead)
            if first and not _clearly_better_alone(state, own[i], best.term, blocks):
                _exchange(state, own[i], best.term, other, tied=True)
            else:
                _change(state, own[i], partial(Finding.tied_with, term=best.term))


def _clearly_better_alone(state: State, term: Term, other: Term, blocks: Blocks) -> bool:
    """Whether an effect fits clearly better than another, both next to certain effects and effects
    of the controller only."""
    own = state.fit.effects
    known = [t for t in own if t is not term and (t.effect.first or isinstance(t, DriveTerm))]
    if len(known) + 1 == len(own):
        return False

    def alone(single: Term) -> Scored:
        return scored(compared(state.prepared, (*known, single), state.fit.shape), blocks)

    return distinguishable(alone(term), alone(other))


def settle_ties(state: State) -> None:
    """Compare each effect with the best one with more parameters that does not contain it, nor is
    it: end stops that leave no room between them are a spring.

    Both are tied if they explain as much; of a tie, one that explains clearly more is named. This
    requires that all effects have been found: before, what the simpler effect leaves may come from
    another effect.
    """
    for i in range(len(state.fit.effects)):
        own, blocks = state.fit.effects, state.blocks
        simple = _candidate(state.fit, i)
        richer = [
            c
            for c in _alternatives(state, own[i])
            if numbers_of(c.term) > numbers_of(own[i]) and not c.contains(simple)
        ]
        if not richer or is_unnamed(own[i]):
            continue
        best, other = _in_place_of(state, blocks, i, richer)
        if simple.contains(_candidate(other, i)):
            continue
        now, instead = scored(state.fit, blocks), scored(other, blocks)
        if as_good(now, instead):
            if as_good(instead, now):
                _change(state, own[i], partial(Finding.tied_with, term=best.term))
        elif any(best.term.name in f.ties for f in state.findings if f.term.name == own[i].name):
            _exchange(state, own[i], best.term, other, tied=True)


def _candidate(fitted: Fit, i: int) -> Candidate:
    return Candidate(fitted.effects[i], fitted.jacobian[:, fitted.layout.coefficients(i)])


def exchange_drive(state: State, rng: np.random.Generator) -> bool:
    """Try to replace each effect of the drive, with all later effects in the model.

    Effects of the drive are found first, with a law that lacks the other effects and is biased, so
    the wrong form, or an effect of the drive instead of one of the joint, may fit better. An effect
    that explains nearly as much is a tie; among such forms the first in the catalogue is used.

    Returns:
        whether another effect predicts clearly more, another form more, or a simpler effect as
        much.
    """
    own = state.fit.effects
    for i, term in enumerate(own):
        if not isinstance(term, DriveTerm):
            continue
        now = scored(state.fit, state.blocks)
        for other, seen in [*_other_drives(state, i), *_joints_instead(state, i, rng)]:
            instead = other.effects[i]
            simpler = size_of(other) < size_of(state.fit)
            alike = instead.name == term.name
            before = scored(other, state.blocks)
            if distinguishable(now, before) and not simpler:
                continue
            if now.better(before) and not (simpler or alike):
                _change(state, term, partial(Finding.tied_with, term=instead))
                continue
            prepared, other = reweighed(state.prepared, other)
            after = state.blocks_of(prepared, other)
            same = scored(state.under(prepared), after)
            score = scored(other, after)
            if alike:
                taken = _form_preferred(instead, score, term, same)
            else:
                enough = as_good(score, same) or is_small(term, same, score)
                taken = enough if simpler else improves(score, same)
            if taken:
                _change(state, term, partial(_instead, term=instead, seen=seen))
                state.prepared, state.fit = prepared, other
                return True
            if alike and not distinguishable(same, score):
                _change(state, term, partial(_with_form, other=instead))
    return False


def _form_preferred(one: Term, score: Scored, other: Term, its: Scored) -> bool:
    """Whether one form of an effect of the drive is preferred to another, after refitting.

    Indistinguishable forms are ordered as in the catalogue.
    """
    assert isinstance(one, DriveTerm)
    assert isinstance(other, DriveTerm)
    order = DRIVE_EFFECTS.index(one.effect) - DRIVE_EFFECTS.index(other.effect)
    if order == 0:
        return score.better(its)
    return distinguishable(score, its) if order > 0 else not distinguishable(its, score)


def _other_drives(state: State, i: int) -> list[tuple[Fit, Look]]:
    """Models with another effect of the drive in place of the i-th, with the step that tried it."""
    name = state.fit.effects[i].name
    seen = next(f.look for f in state.findings if f.term.name == name)
    others = others_of_drive(state.prepared, state.fit, i)
    return [(f, seen) for f in others if seen.holds(f.effects[i])]


def _joints_instead(state: State, i: int, rng: np.random.Generator) -> list[tuple[Fit, Look]]:
    """Replace the i-th effect by the most promising joint effects with no more parameters.

    The law is kept as fitted with the effect, because a refit without it would be biased.
    """
    own, law = state.fit.effects, state.fit.shape
    rest = replace(state, fit=refit(state.prepared, all_but(own, own[i]), law, steps=1))
    among = [
        c for c in rest.candidates if not c.unnamed and numbers_of(c.term) <= numbers_of(own[i])
    ]
    if not among:
        return []
    seen, _ = look(rest.fit, rest.blocks, among, rng)
    terms = [in_place(own, i, r.candidate.term) for r in seen.rows[:ALTERNATIVES]]
    return [(compared(state.prepared, t, law), seen) for t in terms]


def _change(state: State, term: Term, change: Callable[[Finding], Finding]) -> None:
    """Replace the finding of an effect of the model."""
    own = finding_of(state.findings, term)
    state.findings = [change(f) if f is own else f for f in state.findings]


def _exchange(state: State, term: Term, instead: Term, model: Fit, tied: bool = False) -> None:
    """Use a model with another effect in place of one of its effects, and tied with it or not."""

    def changed(finding: Finding) -> Finding:
        new = _instead(finding, instead)
        return new.tied_with(finding.term) if tied else new

    _change(state, term, changed)
    state.prepared, state.fit = reweighed(state.prepared, model)


def _with_form(finding: Finding, other: Term) -> Finding:
    """A finding of an effect of the drive, with another form that explains the logs as well."""
    assert isinstance(finding.term, DriveTerm)
    assert isinstance(other, DriveTerm)
    if other.effect in (finding.term.effect, *finding.forms):
        return finding
    return replace(finding, forms=(*finding.forms, other.effect))


def _instead(finding: Finding, term: Term, seen: Look | None = None) -> Finding:
    """A finding of one effect, rewritten for another effect.

    Args:
        seen: the step that tried the other effect; None: the step of the finding.
    """
    look = seen or finding.look
    row = look.find(term)
    ties = tuple(name for name in finding.ties if name != row.name)
    return replace(finding, term=term, look=look, row=row, ties=ties, forms=())


def _in_place_of(
    state: State, blocks: Blocks, i: int, others: list[Candidate]
) -> tuple[Candidate, Fit]:
    """The most promising candidate in place of the i-th effect, and the model with it."""
    best = best_first(state, blocks, i, others)[0]
    terms = in_place(state.fit.effects, i, best.term)
    return best, compared(state.prepared, terms, state.fit.shape)


def best_first(state: State, blocks: Blocks, i: int, others: list[Candidate]) -> list[Candidate]:
    """Candidates for replacing the i-th effect, most promising first."""
    seen = screen(state.fit, blocks, others)
    rest = [at for k, at in enumerate(seen.terms) if k != i]
    left = [float(seen.held_out([*rest, at])[0].sum()) for at in seen.candidates]
    return [others[k] for k in in_order(range(len(others)), lambda k: left[k])]


def _alternatives(state: State, term: Term) -> list[Candidate]:
    """Named candidates from the step of the search that added an effect of the model."""
    looks = [f.look for f in state.findings if f.term.name == term.name]
    named = [c for c in state.candidates if not c.unnamed]
    return [c for c in named if all(look.holds(c.term) for look in looks)]
