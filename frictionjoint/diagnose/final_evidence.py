"""The evidence for each effect, recomputed on the final model.

An effect was accepted while the model had another law and other effects. So each effect is examined
again, as if it alone were missing, and all candidates compete for its place. The law keeps the
parameters fitted with the effect, because refitted without it, it would be biased. The best
candidates are then fitted in its place.

An effect is dropped if neither its coefficient nor its shape predicts held-out motion, or if fewer
than half of the random halves of the data prefer it to the candidates and to no effect. A candidate
that explains as much as the effect, within the standard error, is a tie. An effect whose size is
within two standard errors of zero is dropped first, unless several such effects carry the evidence
together and held-out prediction gets worse without this one.

The p-value stays that of the step that accepted the effect; of a pair, one effect may have been
insignificant then, and has that of the final model.
"""

import itertools
from dataclasses import replace

import numpy as np

from frictionjoint.decisions import MOSTLY, SIGNIFICANCE, TIE
from frictionjoint.diagnose.determined import undetermined
from frictionjoint.diagnose.drop import drop_redundant
from frictionjoint.diagnose.finding import Finding, finding_of
from frictionjoint.diagnose.moves import ALTERNATIVES, Look, Looked
from frictionjoint.diagnose.one_missing import candidates_without
from frictionjoint.diagnose.physical_bounds import exceeding_friction
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, as_good, improves, numbers_of, with_fewer, without
from frictionjoint.identify.blocks import halves
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import reweighed


def final_evidence(state: State, rng: np.random.Generator) -> tuple[Finding, ...]:
    """The effects of the model, each with its evidence; effects without support are dropped."""
    while True:
        unsure = _leave_out_undetermined(state)
        found = _of_terms(state)
        seen = [_seen_alone(state, f, rng) for f in found]
        # what keeps its evidence is not judged by it
        weak = [s for s, f in zip(seen, found, strict=True) if s is not f and not _is_supported(s)]
        if not weak:
            # effects whose sizes are not determined are tied: each is a cause of that
            for term in unsure:
                seen = [f.tied_with(term) if f.term in unsure else f for f in seen]
            return tuple(seen)
        least = min(weak, key=lambda f: f.row.frequency).term
        state.left_out[least.name] = "most parts of the data do not confirm it"
        state.prepared, state.fit = reweighed(state.prepared, without(state, least))
        drop_redundant(state)


def _leave_out_undetermined(state: State) -> list[Term]:
    """Remove, one after the other, effects whose sizes the logs do not determine.

    One without which held-out prediction gets worse stays, and the report says that its size is not
    determined. But if the logs determine no effect, one with a standard error above its size stays
    only if it removes nearly all of the residual, as the law's own error does not: a slow change is
    certain long before its end and its rate are known.

    Returns:
        those that stay.
    """
    changed = False
    while unsure := _unsure(state):
        blocks = state.blocks
        now = scored(state.fit, blocks)
        fits = {term: without(state, term) for term in unsure}
        scores = {term: scored(f, blocks) for term, f in fits.items()}
        idle = [fits[term] for term, its in scores.items() if not improves(now, its)]
        least = min(unsure, key=lambda term: unsure[term])
        open_size = unsure[least] >= 1.0 or len(unsure) < len(state.fit.effects)
        much = now.gain(scores[least]) >= 1.0 - TIE
        # a size beyond all friction is none, whatever the model has besides
        if not idle and unsure[least] > 0.0 and (open_size or much):
            break
        fewer = best_of(idle, lambda f: f.drive_rms) if idle else fits[least]
        gone = next(term for term, f in fits.items() if f is fewer)
        state.left_out[gone.name] = "these logs do not determine its size"
        state.prepared, state.fit = reweighed(state.prepared, fewer)
        changed = True
    if changed:
        drop_redundant(state)
    return list(unsure)


def _unsure(state: State) -> dict[Term, float]:
    """Effects whose sizes are open, with the distance from zero in standard errors; 0 if a size is
    more than the joint's friction."""
    beyond = dict.fromkeys(exceeding_friction(state.fit), 0.0)
    return undetermined(state.prepared, state.fit) | beyond


def _of_terms(state: State) -> list[Finding]:
    """The finding of each effect."""
    names = {term.name for term in state.fit.effects}
    found = [(term, finding_of(state.findings, term)) for term in state.fit.effects]
    return [
        replace(f, term=term, ties=tuple(name for name in f.ties if name not in names))
        for term, f in found
    ]


def _seen_alone(state: State, finding: Finding, rng: np.random.Generator) -> Finding:
    """A finding with the evidence of its effect next to the rest of the model.

    Effects of the drive, which are no candidates, and effects that are no longer candidates keep
    their earlier evidence.
    """
    rest = replace(state, fit=without(state, finding.term))
    _, seen = candidates_without(state, finding.term, rng)
    row = next((r for r in seen.rows if r.name == finding.term.name), None)
    if row is None:
        return finding
    rivals = _rivals(seen, finding, row)
    instead = [with_fewer(rest, (*rest.fit.effects, t)) for t in rivals]
    now, bare, *others = (scored(f, rest.blocks) for f in (state.fit, rest.fit, *instead))
    close = _within_error(seen, row)
    alike = [
        term.name in close or (as_good(now, other) and as_good(other, now))
        for term, other in zip(rivals, others, strict=True)
    ]
    for term in itertools.compress(rivals, alike):
        finding = finding.tied_with(term)
    least = min(others, key=lambda other: other.total, default=None)
    if least is not None:
        name = rivals[others.index(least)].name
        finding = replace(finding, against=(name, now.gain(bare) - least.gain(bare)))
    others = [other for other, same in zip(others, alike, strict=True) if not same]
    half = halves(rest.blocks.count, rng)
    ahead = [half @ now.squares < half @ other.squares for other in (bare, *others)]
    chosen = float(np.mean(np.all(ahead, axis=0)))
    # shapes were chosen on all of the data for the one gain, without each fold for the other
    gain = min(now.gain(bare), seen.gain(row))
    # one of a pair need not have been significant while the other one was missing
    came = finding.row.p_value
    row = row._replace(frequency=chosen, p_value=came if came <= SIGNIFICANCE else row.p_value)
    return replace(finding, look=seen, row=row, gain=gain)


def _within_error(seen: Look, row: Looked) -> set[str]:
    """Names of effects of a step whose residual is about equal, within its standard error."""
    gain = seen.gain(row)
    found = set()
    for other in seen.rows:
        more = other.left - row.left
        error = float(np.std(more)) * np.sqrt(len(more))
        if seen.gain(other) >= (1.0 - TIE) * gain and abs(float(more.sum())) <= error:
            found.add(other.name)
    return found


def _rivals(seen: Look, finding: Finding, row: Looked) -> list[Term]:
    """The best alternatives to an effect with no more numbers, without its ties."""
    terms = [r.candidate.term for r in seen.rows if not r.candidate.unnamed]
    own = {row.name, *finding.ties}
    most = numbers_of(finding.term)
    return [t for t in terms if t.name not in own and numbers_of(t) <= most][:ALTERNATIVES]


def _is_supported(finding: Finding) -> bool:
    """Whether it predicts motion that it was not fitted to, and most halves of the data choose it.

    Effects that are certain to exist are always supported.
    """
    chosen = finding.gain > 0.0 and finding.row.frequency >= MOSTLY
    return finding.term.effect.first or chosen
