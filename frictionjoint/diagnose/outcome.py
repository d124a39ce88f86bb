"""Finish the search: remove unnamed terms, drop redundant effects, collect evidence.

Where the drive is reconstructed, models are compared by simulated motion too.
"""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY, TIE
from frictionjoint.diagnose.candidate import is_unnamed
from frictionjoint.diagnose.detection_limit import detection_limit
from frictionjoint.diagnose.drop import drop_redundant
from frictionjoint.diagnose.exchange import best_first, best_forms, settle_ties, try_other_effects
from frictionjoint.diagnose.final_evidence import final_evidence
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.moves import ALTERNATIVES, look
from frictionjoint.diagnose.other_laws import forms_like
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, compared, distinguishable, without
from frictionjoint.effects.catalogue import title
from frictionjoint.identify.assumptions import with_assumptions
from frictionjoint.identify.base_fit import with_last_freedoms
from frictionjoint.identify.basis import lengths
from frictionjoint.identify.basis import without as projected_out
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import units_of
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import (
    ExcessTerm,
    MissingTerm,
    NotGiven,
    SmoothTerm,
    SplineTerm,
    as_delivered,
)
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import Term, all_but, in_place
from frictionjoint.identify.weights import reweighed

# mean square error of each run of logs simulated with a fit to them, rad^2 (m^2), or None
Replayed = Callable[[Prepared, Fit], Array | None]


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
        state.unnamed = _unnamed_torque(before, with_unnamed, state.prepared, state.fit)
        unit, _ = units_of(state.fit, state.prepared.slide)
        causes |= {term.name: term.says(np.array([x]), unit) for term, x in not_given}
        hints += [causes[term.name] for term, _ in not_given]
        drop_redundant(state)
    findings: tuple[Finding, ...] = ()
    # a model without effects is the law alone
    if state.fit.effects or not_given:
        findings = _settled(state, replayed, by_motion, rng)
    prepared, base = with_assumptions(*with_last_freedoms(*alone))
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


def _unnamed_torque(before: Prepared, fitted: Fit, now: Prepared, named: Fit) -> tuple[Array, ...]:
    """Torque of the unnamed terms of a fit at the samples that its logs still contain, (n, 1) each.

    What the model without them, `named`, could explain of it is evidence for its effects. Torque
    that a saturated sensor does not measure acts only at samples that are left out.
    """
    pairs = zip(before.segments, now.segments, strict=True)
    still = np.concatenate([new.kept[old.kept] for old, new in pairs])
    w, known = named.weight, named.free_jacobian * named.weight[:, None]
    return tuple(
        (projected_out(fitted.term_torque(i)[still] * w, known / lengths(known)) / w)[:, None]
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
    named = tuple(t for t in state.fit.effects if not is_unnamed(t))
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


def nearer(errors: Array, now: Array) -> bool:
    """Whether the errors of simulated runs are clearly smaller: by a fraction of the rms, and by a
    paired standard error."""
    gained = now - errors
    enough = errors.sum() < (1.0 - CLEARLY) ** 2 * now.sum()
    return bool(enough and gained.sum() > np.std(gained) * np.sqrt(len(gained)))


def moving_nearest(state: State, replayed: Replayed) -> bool:
    """Use another local minimum of the law if its simulated motion is nearer to the logs; return
    whether one is used.

    Errors in a reconstructed drive bias the law: several local minima explain the torque equally
    well and simulate quite different motions.
    """
    now = replayed(state.prepared, state.fit)
    if now is None:
        return False
    best, least = None, now
    for other in state.laws.near(state.prepared, state.fit):
        errors = replayed(state.prepared, other)
        if errors is not None and nearer(errors, now) and errors.sum() < least.sum():
            best, least = other, errors
    if best is None:
        return False
    moved = refit(state.prepared, best.effects, best.shape, ROUGH)
    prepared, moved = reweighed(*settled(*reweighed(state.prepared, moved)))
    errors = replayed(prepared, moved)
    if errors is None or not nearer(errors, now):
        return False
    state.prepared, state.fit = prepared, moved
    return True


def quantities_alike(state: State, blocks: Blocks, i: int) -> dict[str, float]:
    """Quantities that explain as much as the quantity of the i-th effect, if that is a curve.

    In an arm that moves alone the load is a function of position, and no log distinguishes them.

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
    bare = scored(compared(state.prepared, all_but(own, term), state.fit.shape), blocks)
    found = {}
    for instead in list(best.values())[:ALTERNATIVES]:
        terms = in_place(own, i, instead)
        other = scored(compared(state.prepared, terms, state.fit.shape), blocks)
        # a difference that a few blocks carry is not significant, however large
        alike = other.gain(bare) >= (1.0 - TIE) * now.gain(bare)
        if alike and not distinguishable(now, other):
            found[instead.name] = other.gain(bare)
    return found
