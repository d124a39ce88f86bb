"""Search for missing effects.

    fit the law; repeat: screen every change of the model, refit the best few, accept the best one
    that predicts unlike motion better; drop redundant effects; until nothing improves, also for
    effects that another law could imitate, and for exchanges of effects.

One score decides: the sum of squares predicted by effects fitted to other motion (`score`). A
change is accepted if it gains more than one paired standard error and a least fraction of the
residual sum of squares, and if chance hardly does as much over the whole family of candidates.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.decisions import APART, SMALLEST_GAIN, TIE
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.choice import Choice, Tried, beyond_chance, chosen, may_gain, rivals_of
from frictionjoint.diagnose.drive import look_at_drive, share_left
from frictionjoint.diagnose.drop import drop_redundant
from frictionjoint.diagnose.exchange import best_forms, exchange_drive, try_other_effects
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.moves import Look, Move, look, promising
from frictionjoint.diagnose.one_missing import better_than_curve, named_instead
from frictionjoint.diagnose.other_laws import OtherLaws, forms_like
from frictionjoint.diagnose.outcome import Replayed, finish_search
from frictionjoint.diagnose.score import Scored, scored
from frictionjoint.diagnose.state import (
    MOST_CHANGES,
    State,
    compared,
    is_small,
    numbers_of,
    with_fewer,
)
from frictionjoint.identify.base_fit import base_fit, slow_fit
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import CLOSE, ROUGH, nearer
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import settled, swinging
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import reweighed
from frictionjoint.parameters import FrictionParameters
from frictionjoint.threads import one_thread, side_by_side

INTEGRATED_LAW = FrictionParameters.law


@one_thread
def trace(
    prepared: Prepared,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    law: str | None = None,
    replayed: Replayed = lambda prepared, fitted: None,
    by_motion: bool = False,
) -> Trace:
    """Run the search on prepared logs; it uses these logs only, split into folds.

    Args:
        seed: for sign flips and resampling; equal seeds give equal results.
        progress: called with a description of the current step.
        law: name of the friction law; None for the integrated law.
        replayed: function that simulates logs with a fit and returns the mean square error of each
            run, rad^2 (m^2), shape (k,), or None.
        by_motion: among local minima of the law with similar torque errors, use the one with the
            smallest position error.
    Raises:
        ParameterError: no law has this name.
    """
    rng = np.random.default_rng(seed)
    progress("fitting the friction law")
    prepared, alone = base_fit(prepared, law or INTEGRATED_LAW, progress)
    laws = OtherLaws(prepared, alone, progress)
    state = State(prepared, alone, [], Look((), np.zeros(0), 0.0), laws)
    _follow(state)
    while True:
        _search(state, rng, progress)
        # finishing changes the model; the search goes on from the one before
        ended = replace(state, left_out={})
        found = finish_search(ended, (prepared, alone), replayed, by_motion, rng)
        # of two waves one may go: the other one is no reason to search without both
        gone = {x: why for x, why in ended.left_out.items() if x not in _names(ended)}
        if gone.keys() <= state.excluded.keys():
            return found
        # an effect that was removed may have hidden another one from the search
        state.excluded |= gone
        stays = tuple(t for t in state.fit.effects if t.name not in state.excluded)
        state.prepared, state.fit = reweighed(state.prepared, with_fewer(state, stays))
        state.forget_dropped()
        _follow(state)


def _search(state: State, rng: np.random.Generator, progress: Callable[[str], None]) -> None:
    """Change the model until no change is justified."""
    laws = state.laws
    bent = False
    known = {_names(state)}
    for change in range(1, MOST_CHANGES + 1):
        progress(f"looking for missing effect {change}")
        state.law_errs = True
        before, left = _names(state), state.fit.drive_rms
        if taken := _step(state, rng):
            progress(f"missing effect {change}: {', '.join(taken)}")
        # what is named now may have bent the laws, and as long as a drive is off they are bent
        bent = bent or state.fit.drive_rms**2 < (1.0 - APART) * left**2
        # certain effects and effects of the drive come first, and more of them may follow
        early = all(t.effect.first or t.effect.drive for t in state.fit.effects)
        if bent and not (taken and early):
            laws.fit_from_all_starts(state.prepared, state.fit.effects)
            bent = False
        changed: list[str] | bool = _follow(state) or taken
        if not changed and exchange_drive(state, rng):
            drop_redundant(state)
            changed = True
        if not changed:
            # what another law would explain in part may be an effect after all
            state.law_errs = False
            first = [] if state.fit.effects else _first(state)
            changed = _taken(state, first, rng) or _taken(state, state.candidates, rng)
        if not changed or (_names(state) != before and _names(state) in known):
            break  # effects that come back would do so without end
        known.add(_names(state))


def _names(state: State) -> tuple[str, ...]:
    return tuple(sorted(t.name for t in state.fit.effects))


def _step(state: State, rng: np.random.Generator) -> list[str]:
    """Make one change of the model, if any is justified; return the names of added effects.

    Effects that are certain to exist are tried first, then effects of the drive, then all others.
    The evidence for each group is unreliable while an effect of an earlier group is missing.
    """
    if state.fit.effects:
        taken = _of_drive(state, rng)
    else:
        first = _first(state)
        taken = _taken(state, first, rng) or _drive_with_certain_effect(state, first, rng)
    return taken or _taken(state, state.candidates, rng)


def _first(state: State) -> list[Candidate]:
    return [c for c in state.candidates if c.term.effect.first]


def _drive_with_certain_effect(
    state: State, first: Sequence[Candidate], rng: np.random.Generator
) -> list[str]:
    """Add the best effect of the drive together with a certain effect, if that is justified.

    A grossly wrong drive model masks certain effects, and without them the effect of the drive is
    misidentified: overload protection without the motor's back-EMF looks like a limit.
    """
    if not first:
        return _of_drive(state, rng)
    seen = state.look
    fitted = compared(state.prepared, tuple(c.term for c in first), state.fit.shape)
    findings = [
        Finding(term, seen, seen.find(term), seen.gain(seen.find(term)), (), (), fitted)
        for term in fitted.effects
    ]
    prepared, fitted = reweighed(state.prepared, fitted)
    own = replace(state, prepared=prepared, fit=fitted, findings=findings, look=seen)
    taken = _of_drive(own, rng)
    if taken:
        state.prepared, state.fit, state.look = own.prepared, own.fit, own.look
        state.findings = own.findings
    return taken


def _of_drive(state: State, rng: np.random.Generator) -> list[str]:
    """The best effect of the drive, if one is justified."""
    found = look_at_drive(state.prepared, state.fit, rng)
    if found is None or not found.tried:
        return []
    term, score = found.tried[0]
    gain = score.gain(found.now)
    row = found.look.rows[0]
    enough = gain >= SMALLEST_GAIN and score.better(found.now)
    # less of a drive that hardly acts is left, and as much of it
    lesser = share_left(score.fit) ** 2 <= (1.0 - SMALLEST_GAIN) * share_left(found.now.fit) ** 2
    if not (enough and lesser) or is_small(term, score, found.now):
        return []
    # under the weights that it gives the logs there may be less that it explains
    prepared, driven = reweighed(state.prepared, score.fit)
    after = state.blocks_of(prepared, driven)
    if is_small(term, scored(driven, after), scored(state.under(prepared), after)):
        return []
    if state.laws.suffice(state.prepared, state.fit, driven):
        return []
    near = [
        other.name
        for other, its in found.tried[1:]
        if its.gain(found.now) >= (1.0 - TIE) * gain and not score.better(its)
    ]
    state.look = found.look
    state.prepared, state.fit = prepared, driven
    state.findings.append(Finding(term, found.look, row, gain, tuple(near), (), state.fit))
    drop_redundant(state)
    return [f.term.name for f in state.findings if f.term is term]


def _taken(state: State, candidates: Sequence[Candidate], rng: np.random.Generator) -> list[str]:
    """The best of these candidates, if it is justified."""
    if not candidates:
        return []
    prepared, current, blocks = state.prepared, state.fit, state.blocks
    seen, screened = look(current, blocks, candidates, rng)
    state.look = seen
    now = scored(current, blocks)

    def attempt(move: Move) -> Tried:
        own, found = _compared(prepared, current, move)
        return Tried(move, own, scored(found, blocks))

    worth = [
        m
        for m in promising(current, seen, screened, candidates)
        if beyond_chance(m) and may_gain(m) and not state.refuses(m)
    ]
    with side_by_side() as each:
        tried = list(each(attempt, worth))
    tried = [t for t in tried if not any(is_small(c.term, t.score, now) for c in t.move.added)]
    choice = chosen(now, tried)
    if choice:
        now, tried = _rescreened(state, now, tried, choice.taken, rng)
        choice = chosen(now, tried)
    while choice:
        changed = _changed(state, choice, tried, now)
        names = _more(changed.fit, state.fit, choice.taken.move)
        # what replaces an effect need not explain more than that one
        grown = _size(changed.fit) > _size(state.fit)
        if names and not (grown and state.laws.suffice(state.prepared, state.fit, changed.fit)):
            state.prepared, state.fit = changed.prepared, changed.fit
            state.findings = changed.findings
            if best_forms(state):
                drop_redundant(state)
            try_other_effects(state)
            return names
        # nothing of it was needed once it was in, or with another law: the next best
        state.refuse(choice.taken.move)
        tried = [t for t in tried if t is not choice.taken]
        choice = chosen(now, tried)
    return []


def _size(fitted: Fit) -> int:
    return sum(map(numbers_of, fitted.effects))


def _compared(prepared: Prepared, current: Fit, move: Move) -> tuple[Prepared, Fit]:
    """A change fitted to the logs, including the initial state that it adds."""
    begun = prepared
    for c in move.added:
        if c.begun is not None:
            begun = swinging(begun, current, c.term, c.columns, c.begun)
    # where a torque leaps derivatives come to rest too early, and two effects do so more often
    settles = len(move.added) > 1 and any(c.term.effect.leaps for c in move.added)
    found = compared(begun, move.terms, current.shape, CLOSE if settles else ROUGH)
    return (prepared, found) if begun is prepared else settled(begun, found)


def _changed(state: State, choice: Choice, tried: Sequence[Tried], now: Scored) -> State:
    """The model after a change, without effects that became redundant."""
    taken = choice.taken
    prepared, fitted = settled(*reweighed(taken.prepared, taken.score.fit))
    gain, rivals = taken.score.gain(now), rivals_of(taken, tried, now)
    found = []
    for candidate in taken.move.added:
        seen = taken.move.seen if taken.move.seen.holds(candidate.term) else state.look
        row = seen.find(candidate.term)
        its = min(gain, seen.gain(row)) if gain > 0 else gain
        found.append(Finding(candidate.term, seen, row, its, choice.ties, rivals, fitted))
    changed = replace(state, prepared=prepared, fit=fitted, findings=[*state.findings, *found])
    drop_redundant(changed)
    return changed


def _more(after: Fit, before: Fit, move: Move) -> list[str]:
    """Names of the effects that a change added to the model and that are still in it."""
    names, had = ([t.name for t in f.effects] for f in (after, before))
    return [c.term.name for c in move.added if names.count(c.term.name) > had.count(c.term.name)]


def _rescreened(
    state: State, now: Scored, tried: Sequence[Tried], best: Tried, rng: np.random.Generator
) -> tuple[Scored, list[Tried]]:
    """The leading changes, screened again with the weights and the law of the best change.

    The missing effect may have biased the law, the weights and the initial friction states. With an
    unbiased law, a named effect may explain what the best change leaves to an unnamed dependence.
    """
    least = (1.0 - SMALLEST_GAIN) * best.score.gain(now)
    leaders = [best, *(t for t in tried if t is not best and t.score.gain(now) >= least)]
    prepared, first = reweighed(state.prepared, best.score.fit, ROUGH)
    # the weights of a biased law are far from those of the law that follows from them
    prepared, first = settled(*reweighed(prepared, first, ROUGH))
    blocks = state.blocks_of(prepared, first)

    def begun(terms: tuple[Term, ...]) -> tuple[Prepared, Scored]:
        found = compared(prepared, terms, nearer(prepared, terms, (first.shape, state.fit.shape)))
        swung = any(term.effect.free for term in terms)
        own, found = settled(prepared, found) if swung else (prepared, found)
        return own, scored(found, blocks)

    unbiased = replace(state, prepared=prepared, fit=first)
    instead = [m for m in named_instead(unbiased, best.move, rng) if not state.refuses(m)]
    moves = [*(t.move for t in leaders), *instead]
    models = [state.fit.effects, *(t.score.fit.effects for t in leaders)]
    models += [m.terms for m in instead]
    with side_by_side() as each:
        (_, before), *changes = list(each(begun, models))
    again = [Tried(m, *change) for m, change in zip(moves, changes, strict=True)]
    count = len(leaders)
    return before, [*again[:count], *better_than_curve(again[count:], again[0])]


def _follow(state: State) -> bool:
    """Fit all laws with the effects found; use another form of the law if that is better.

    An effect that compensated for the former form may be redundant now and is dropped.

    Returns:
        whether another form is used.
    """
    if state.laws.followed is state.fit:
        return False
    if state.fit.effects and (
        slow := slow_fit(state.prepared, state.fit, forms_like(state.fit.shape))
    ):
        # while an effect was missing the law may have fallen too early for another reason
        state.prepared, state.fit = settled(*slow)
    prepared, found = state.laws.follow(state.prepared, state.fit)
    if found is state.fit:
        return False
    state.prepared, state.fit = prepared, found
    drop_redundant(state)
    return True
