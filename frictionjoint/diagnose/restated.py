"""The evidence of each effect, restated on the final model.

When an effect came in it was seen beside another law and other effects. In the end each is looked
at as if it alone were missing, with all candidates beside it. What chance explains as well, or what
fewer than half of the halves of the data choose, goes.
"""

from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.decisions import MOSTLY, SIGNIFICANCE
from frictionjoint.diagnose.drop import drop_idle
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.library import comes_first
from frictionjoint.diagnose.moves import look
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, without
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed


def restated(state: State, rng: np.random.Generator) -> tuple[Finding, ...]:
    """What the model has, each effect with its evidence; what that does not bear out is dropped."""
    while True:
        found = [_seen_alone(state, f, rng) for f in _of_terms(state)]
        weak = [f for f in found if not _borne_out(f)]
        if not weak:
            return tuple(found)
        least = min(weak, key=_chosen).term
        state.prepared, state.fit = reweighed(state.prepared, without(state, least))
        drop_idle(state)
        state.forget_dropped()


def _of_terms(state: State) -> list[Finding]:
    """The finding of each effect: harmonics of a periodic one came one by one."""
    found: list[Finding] = []
    for term in state.fit.effects:
        own = [f for f in state.findings if f.term.name == term.name]
        before = sum(f.term.name == term.name for f in found)
        found.append(replace(own[min(before, len(own) - 1)], term=term))
    return found


def _seen_alone(state: State, finding: Finding, rng: np.random.Generator) -> Finding:
    """A finding with what is seen of its effect beside the rest of the model.

    Effects of the drive, which are no candidates, and what is no longer one keep what was seen.
    """
    if not isinstance(finding.term, EffectTerm):
        return finding
    rest = replace(state, fit=without(state, finding.term))
    seen, _ = look(rest.fit, rest.blocks, rest.candidates, rng)
    row = next((r for r in seen.rows if r.name == finding.term.name), None)
    if row is None:
        return finding
    gain = scored(state.fit, rest.blocks).gain(scored(rest.fit, rest.blocks))
    # shapes were chosen on all of the data for the one, without each fold for the other
    return replace(finding, look=seen, row=row, gain=min(gain, seen.gain(row)))


def _borne_out(finding: Finding) -> bool:
    """Whether chance hardly explains as much, and most of the data choose it or one of its ties.

    What comes first is known to be there.
    """
    if comes_first(finding.term):
        return True
    return finding.row.p_value <= SIGNIFICANCE and _chosen(finding) >= MOSTLY


def _chosen(finding: Finding) -> float:
    """How often an effect is the best on half of the data, or one that it is tied with."""
    alike = {finding.term.name, *finding.ties}
    return sum(r.frequency for r in finding.look.rows if r.name in alike)
