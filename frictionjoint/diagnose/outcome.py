"""Finish the search: remove unnamed terms, drop redundant effects, collect evidence."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import TIE
from frictionjoint.diagnose.candidate import named_of
from frictionjoint.diagnose.detection_limit import detection_limit
from frictionjoint.diagnose.drop import drop_redundant
from frictionjoint.diagnose.exchange import best_forms, settle_ties, try_other_effects
from frictionjoint.diagnose.final_evidence import final_evidence
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.motion_check import Replayed, moving_nearest, nearer
from frictionjoint.diagnose.moves import look
from frictionjoint.diagnose.other_laws import forms_like
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, without
from frictionjoint.diagnose.unnamed import quantities_alike
from frictionjoint.effects.catalogue import title
from frictionjoint.identify.assumptions import with_assumptions
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.instruments import ExcessTerm, MissingTerm, NotGiven, as_delivered
from frictionjoint.identify.last_freedoms import with_last_freedoms
from frictionjoint.identify.result import units_of
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit
from frictionjoint.identify.weights import reweighed


def finish_search(
    state: State,
    alone: tuple[Prepared, Fit],
    replayed: Replayed,
    by_motion: bool,
    rng: np.random.Generator,
) -> Trace:
    """Finish the search. Unnamed dependences are reported, not kept in the model.

    Args:
        alone: fit of the law alone, and the logs with its weights.
    """
    unexplained: dict[str, float] = {}
    hints: list[str] = []
    causes: dict[str, str] = {}
    blocks = state.blocks
    whole = scored(state.fit, blocks)
    for i, term in enumerate(state.fit.terms):
        if isinstance(term, SmoothTerm):
            gain = whole.gain(scored(without(state, term), blocks))
            largest = gain >= unexplained.get(term.name, 0.0)
            unexplained[term.name] = max(gain, unexplained.get(term.name, 0.0))
            alike = quantities_alike(state, blocks, i)
            for name, its in alike.items():
                unexplained[name] = max(its, unexplained.get(name, 0.0))
            hints += [_alike_hint(term.name, name) for name in alike]
            if not state.prepared.gain_unknown and not isinstance(term, ExcessTerm):
                unit, _ = units_of(state.fit, state.prepared.slide)
                hints.append(term.says(state.fit.term_coefficients(i), unit))
                if largest:
                    causes[term.name] = hints[-1]
    not_given: tuple[NotGiven, ...] = ()
    # of several dependences one may be left without its share
    said = {name: x for name, x in unexplained.items() if x >= TIE * max(unexplained.values())}
    if unexplained:
        before, with_unnamed = state.prepared, state.fit
        not_given = _without_unnamed(state, replayed)
        state.unnamed = _unnamed_torque(before, with_unnamed, state.prepared)
        unit, _ = units_of(state.fit, state.prepared.slide)
        causes |= {term.name: term.says(np.array([x]), unit) for term, x in not_given}
        hints += [causes[term.name] for term, _ in not_given]
        drop_redundant(state)
    findings: tuple[Finding, ...] = ()
    # a model without effects is the law alone
    if state.fit.effects or not_given:
        findings = _settled(state, replayed, by_motion, rng)
    prepared, base = with_last_freedoms(*alone)
    prepared, base = with_assumptions(prepared, base)
    if findings or not_given:
        state.prepared, state.fit = with_assumptions(state.prepared, state.fit)
    else:
        state.prepared, state.fit = prepared, base
    left_out = state.excluded | state.left_out
    if left_out and not findings:
        # the last step looked for what the model lacks besides the effects that it had
        state.look, _ = look(state.fit, state.blocks, state.candidates, rng)
        for name, why in sorted(left_out.items()):
            hints.append(f"The search added {title(name)} and removed it again: {why}.")
    return Trace(
        prepared=state.prepared,
        base=base,
        findings=findings,
        final=state.fit,
        unexplained=tuple(sorted(said.items(), key=lambda x: -x[1])),
        hints=tuple(filter(None, hints)),
        causes={name: causes[name] for name in said if causes.get(name)},
        not_given=not_given,
        last_look=state.look,
        other_laws=state.laws.compared(state.prepared, state.fit),
        detection_limit=detection_limit(
            state.prepared, state.fit, state.look.chance, state.blocks, state.candidates
        ),
    )


def _settled(
    state: State, replayed: Replayed, by_motion: bool, rng: np.random.Generator
) -> tuple[Finding, ...]:
    """Fit the model to its end; the effects that it still needs, with their evidence."""
    state.prepared, state.fit = reweighed(*settled(state.prepared, state.fit))
    # the law followed the effects from a fit without them, which may be another local minimum
    anew = fit(state.prepared, state.fit.effects, forms_like(state.fit.shape))
    if anew.clearly_better(state.fit):
        state.prepared, state.fit = reweighed(*settled(state.prepared, anew))
    prepared, found = with_last_freedoms(state.prepared, state.fit)
    if found is not state.fit:
        state.prepared, state.fit = prepared, found
        drop_redundant(state)
    if by_motion and moving_nearest(state, replayed):
        drop_redundant(state)
    # with another law, or fewer effects, other forms and effects may explain as much now
    if best_forms(state):
        drop_redundant(state)
    try_other_effects(state)
    settle_ties(state)
    return final_evidence(state, rng)


def _alike_hint(one: str, other: str) -> str:
    first, second = (name.removesuffix("_c") for name in (one, other))
    return (
        f"These logs do not show whether {first} or {second} is the cause, because both fit "
        "equally well."
    )


def _unnamed_torque(before: Prepared, fitted: Fit, now: Prepared) -> tuple[Array, ...]:
    """Torque of the unnamed terms of a fit at the samples that its logs still contain, (n, 1) each.

    Torque that a saturated sensor does not measure acts only at samples that are left out.
    """
    pairs = zip(before.segments, now.segments, strict=True)
    still = np.concatenate([new.kept[old.kept] for old, new in pairs])
    return tuple(
        fitted.term_torque(i)[still, None]
        for i, term in enumerate(fitted.terms)
        if isinstance(term, SmoothTerm) and not isinstance(term, MissingTerm)
    )


def _without_unnamed(state: State, replayed: Replayed) -> tuple[NotGiven, ...]:
    """Remove unnamed terms and correct for measured torque that was not delivered.

    A correlation of the residual with the measured torque says little, because it is part of it. So
    the simulated motion, driven by the corrected torque, must improve, if it can be simulated.

    Returns:
        the corrections.
    """
    if any(isinstance(term, MissingTerm) for term in state.fit.terms):
        state.prepared = state.prepared.without_limits()
    named = named_of(state.fit.effects)
    # fitted with the unnamed terms, the law may be in a poor local minimum without them
    starts = state.laws.starts(state.fit.shape)
    fits = [refit(state.prepared, named, law) for law in starts]
    asked = state.prepared, best_of(fits, lambda f: f.drive_rms)
    not_given = tuple(
        (term, float(state.fit.term_coefficients(i)[0]))
        for i, term in enumerate(state.fit.terms)
        if isinstance(term, ExcessTerm)
    )
    if not_given:
        prepared = as_delivered(state.prepared, not_given)
        acted = prepared, refit(prepared, named, state.fit.shape)
        before, after = replayed(*asked), replayed(*acted)
        if before is None or after is None or nearer(after, before):
            state.prepared, state.fit = reweighed(*acted)
            return not_given
    state.prepared, state.fit = reweighed(*asked)
    return ()
