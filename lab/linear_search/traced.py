"""The search's result: named effects with their evidence, the parametric law, what is left."""

from collections.abc import Callable, Sequence

import numpy as np

from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.last_freedoms import with_last_freedoms
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import EffectTerm, Term, all_but
from frictionjoint.identify.weights import reweighed
from frictionjoint.threads import one_thread
from linear_search.columns import causes, effects
from linear_search.decisions import (
    CLEAR_TORQUE,
    DETERMINED,
    LEAST_TORQUE,
    NEEDED_PART,
    SIGNIFICANCE,
)
from linear_search.evidence import Member, evidence, looked
from linear_search.experiment import Experiment
from linear_search.final_law import parametric, squares_of, weighed
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
) -> Trace:
    """Search, then fit the parametric law with what was named.

    Args:
        seed: of random signs and halves; equal seeds give equal results.
        progress: called with what is being done. law: name of the friction law.
    Raises:
        ParameterError: no law has this name.
    """
    forms = forms_of(law or LAW)
    progress("searching for missing effects")
    found = find(prepared)
    chosen, members = _beyond_chance(found, seed)
    progress("fitting the friction law")
    own = found.experiment
    prepared = weighed(own)
    named = effects(m.candidate for m in members)
    final = parametric(prepared, own, named, forms)
    prepared, final = settled(prepared, final)
    prepared, final = reweighed(prepared, final)
    final = _eliminated(prepared, final)
    final = with_last_freedoms(prepared, final)
    names = [t.name for t in final.effects]
    members = [m for m in members if m.candidate.name in names]
    if len(members) < len(named):
        chosen = found.sets.best(
            tuple(c for c in chosen.models if c.name in names or not effects([c]))
        )
    progress("fitting the friction law alone")
    base = final if not final.effects else _alone(prepared, found.first, forms)
    unexplained = {
        c.name: found.sets.gain(found.sets.without(chosen, c), chosen).part
        for c in causes(chosen.models)
        if not effects([c])
    }
    dependent = dependences(found.sets, chosen, final, seed)
    for d in dependent:
        unexplained.setdefault(d.term.name, d.share)
    last = looked(found.sets, chosen, None, seed)
    findings = []
    for k, m in enumerate(members):
        term = _term_of(final, members, k)
        upto = tuple(_term_of(final, members, i) for i in range(k + 1))
        fit = final if k == len(members) - 1 else refit(prepared, upto, final.shape, ROUGH)
        findings.append(_finding(found, chosen, m, term, fit))
    return Trace(
        prepared=prepared,
        base=base,
        findings=tuple(findings),
        final=final,
        unexplained=tuple(sorted(unexplained.items(), key=lambda x: -x[1])),
        hints=(),
        last_look=last,
        other_laws=(),
        sight=seen(found.sets, chosen, prepared, final, last),
    )


def _beyond_chance(found: Found, seed: int) -> tuple[Set, list[Member]]:
    """The chosen set without what chance explains as well, and the evidence of the rest."""
    chosen = found.chosen
    while True:
        members = evidence(found.sets, chosen, seed)
        chance = max(members, key=lambda m: m.row.p_value, default=None)
        if chance is None or chance.row.p_value <= SIGNIFICANCE:
            return chosen, members
        chosen = found.sets.without(chosen, chance.candidate)


def _alone(prepared: Prepared, own: Experiment, forms: Sequence[Shape]) -> Fit:
    return with_last_freedoms(prepared, parametric(prepared, own, (), forms))


def _eliminated(prepared: Prepared, final: Fit) -> Fit:
    """The fit without effects that the parametric law makes up for, or that are not determined."""
    friction = float(np.sum((final.friction * final.weight) ** 2)) / final.error_unit**2
    while final.effects:
        rows = []
        for k, term in enumerate(final.effects):
            without = refit(prepared, all_but(final.effects, term), final.shape, ROUGH)
            less = squares_of(without) - squares_of(final)
            part = less / max(squares_of(without), 1e-300)
            torque = float(np.sqrt(max(less, 0.0) / max(friction, 1e-300)))
            needed = (part > NEEDED_PART and torque > LEAST_TORQUE) or torque > 2.0 * CLEAR_TORQUE
            rows.append((needed, part, k, without))
        idle = [r for r in rows if not r[0]]
        if not idle:
            over = _over_errors(prepared, final)
            idle = [r for r in rows if over[r[2]] < DETERMINED]
        if not idle:
            break
        final = min(idle, key=lambda r: r[1])[3]
    return final


def _over_errors(prepared: Prepared, fitted: Fit) -> list[float]:
    """Of each effect the largest of its coefficients, or of its times, over its standard error."""
    cov = stated_covariance(prepared, fitted)
    found = []
    for k, term in enumerate(fitted.effects):
        places = fitted.layout.coefficients(k)
        values = fitted.beta[places]
        if not term.coefficients:  # a delay
            places, values = fitted.layout.numbers(k), np.array(term.free_shape)
        errors = np.sqrt(np.maximum(np.diag(cov)[places], 1e-300))
        found.append(float(np.max(np.abs(values) / errors)))
    return found


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
