"""The search's result: named effects with their evidence, the parametric law, what is left."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.nearest import Replayed
from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.identify.base_fit import base_fit
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.last_freedoms import with_last_freedoms
from frictionjoint.identify.result import units_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm, Term, in_place
from frictionjoint.threads import one_thread
from linear_search.columns import causes, effects
from linear_search.decisions import APART, SIGNIFICANCE
from linear_search.evidence import Member, evidence, looked
from linear_search.final_law import eliminated, finished, freed, moving, squares_of, together
from linear_search.find import Found, find
from linear_search.sets import Set
from linear_search.sight import seen
from linear_search.unnamed import dependences

LAW = "integrated"


@one_thread
def traced(
    prepared: Prepared,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    law: str | None = None,
    replayed: Replayed = lambda prepared, fitted: None,
) -> Trace:
    """Search, then fit the parametric law with what was named.

    Args:
        seed: of random signs and halves; equal seeds give equal results.
        progress: called with what is being done. law: name of the friction law.
        replayed: see `trace`.
    Raises:
        ParameterError: no law has this name.
    """
    progress("fitting the friction law")
    alone, base = base_fit(prepared, law or LAW, progress)
    progress("searching for missing effects")
    found = find(prepared)
    chosen, members = _beyond_chance(found, seed)
    named = effects(m.candidate for m in members)
    final = base
    if named:
        progress("fitting the friction law with the effects")
        prepared, final = together(found.experiment, law or LAW, named, base)
        prepared, final = eliminated(prepared, final, base)
        prepared, final = freed(prepared, final)
        prepared, final = moving(prepared, final, base, replayed)
    base = finished(alone, with_last_freedoms(alone, base))
    if not final.effects:
        prepared, final = alone, base
    else:
        final = finished(prepared, final)
    names = [t.name for t in final.effects]
    members = [m for m in members if m.candidate.name in names]
    if len(members) < len(named):
        chosen = found.sets.best(
            tuple(c for c in chosen.models if c.name in names or not effects([c]))
        )
    unexplained = {
        c.name: found.sets.gain(found.sets.without(chosen, c), chosen).part
        for c in causes(chosen.models)
        if not effects([c])
    }
    unit, _ = units_of(final, prepared.slide)
    hints = []
    for d in dependences(found.sets, chosen, final, seed):
        unexplained.setdefault(d.term.name, d.share)
        if not prepared.gain_unknown and not isinstance(d.term, ExcessTerm):
            hints.append(d.term.says(np.array(d.coefficients), unit))
    last = looked(found.sets, chosen, None, seed)
    findings = []
    for k, m in enumerate(members):
        term = _term_of(final, members, k)
        upto = tuple(_term_of(final, members, i) for i in range(k + 1))
        fit = final if k == len(members) - 1 else refit(prepared, upto, final.shape, ROUGH)
        finding = _finding(found, chosen, m, term, fit)
        findings.append(_distinguished(prepared, final, finding))
    progress("fitting other laws")
    return Trace(
        prepared=prepared,
        base=base,
        findings=tuple(findings),
        final=final,
        unexplained=tuple(sorted(unexplained.items(), key=lambda x: -x[1])),
        hints=tuple(filter(None, hints)),
        last_look=last,
        other_laws=OtherLaws(prepared, final).compared(prepared, final),
        sight=seen(found.sets, chosen, prepared, final, last),
    )


def _distinguished(prepared: Prepared, final: Fit, finding: Finding) -> Finding:
    """A finding without ties that leave clearly more beside the parametric law, in its place.

    The law's columns are freer than any law, and hold some of what makes effects differ.
    """
    at = final.effects.index(finding.term)
    near = []
    for other in finding.rivals:
        instead = refit(prepared, in_place(final.effects, at, other), final.shape, ROUGH)
        if squares_of(instead) * (1.0 - APART) < squares_of(final):
            near.append(other)
    return replace(finding, ties=tuple(t.name for t in near), rivals=tuple(near))


def _beyond_chance(found: Found, seed: int) -> tuple[Set, list[Member]]:
    """The chosen set without what chance explains as well, and the evidence of the rest."""
    chosen = found.chosen
    while True:
        members = evidence(found.sets, chosen, seed)
        chance = max(members, key=lambda m: m.row.p_value, default=None)
        if chance is None or chance.row.p_value <= SIGNIFICANCE:
            return chosen, members
        chosen = found.sets.without(chosen, chance.candidate)


def _term_of(final: Fit, members: Sequence[Member], k: int) -> Term:
    """The term of the final fit that a member became; waves have one name, and come in turn."""
    name = members[k].candidate.name
    before = sum(1 for m in members[:k] if m.candidate.name == name)
    return [t for t in final.effects if t.name == name][before]


def _finding(found: Found, chosen: Set, member: Member, term: Term, fitted: Fit) -> Finding:
    """A member of the set with its ties: in each set that explains as much, what stands instead."""
    name = member.candidate.name
    ties: dict[str, EffectTerm] = {}
    forms = []
    for other in found.alike:
        instead = list(effects(other.models))
        for c in causes(chosen.models):
            same = next((o for o in instead if o.name == c.name), None)
            if c.name != name and same:
                instead.remove(same)
        own = [o for o in instead if o.name == name]
        forms += [o.effect for o in own if o.effect is not term.effect]
        if not own:
            ties |= {o.name: o for o in instead}
    return Finding(
        term=term,
        look=member.look,
        row=member.row,
        gain=member.gain,
        ties=tuple(ties),
        rivals=tuple(ties.values()),
        fit=fitted,
        forms=tuple(dict.fromkeys(forms)),
    )
