"""Effects of the drive that explain as much as an effect of the joint.

Effects of the drive are decided before those of the joint (see `trace`). But some can be detected
only after another effect is in the model, when an effect of the joint may already have taken their
place: a delayed target looks like a delayed encoder until the spring is known.
"""

import numpy as np

from frictionjoint.decisions import APART
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.drive import look_at_drive
from frictionjoint.diagnose.finding import Finding, finding_of
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.library import drive_terms
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, as_much, compared, is_small, size_of, without
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.design import Balance
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import COARSE
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term, all_but
from frictionjoint.identify.weights import reweighed


def exchange_for_drive(state: State, rng: np.random.Generator) -> bool:
    """Replace an effect of the joint by one of the drive that explains almost as much.

    The effect of the drive has no more numbers; the replaced effect becomes a tie.

    Returns:
        whether one was replaced.
    """
    own = state.fit.effects
    for replaced in joint_effects_to_replace(state):
        found = look_at_drive(state.prepared, without(state, replaced), rng)
        others = [pair for pair in found.tried if pair[0].name != replaced.name] if found else []
        if found is None or not others:
            continue
        term, score = others[0]
        if size_of(score.fit) > size_of(state.fit):
            continue
        prepared, other = reweighed(state.prepared, score.fit)
        after = state.blocks_of(prepared, other)
        now = scored(state.under(prepared), after)
        instead = scored(other, after)
        bare = scored(compared(prepared, all_but(own, replaced), other.shape), after)
        if is_small(term, instead, bare) or not as_much(instead, now):
            continue
        ties = (replaced.name,) if as_much(now, instead) else ()
        row = found.look.find(term)
        finding = Finding(term, found.look, row, score.gain(found.now), ties, (), other)
        before = finding_of(state.findings, replaced)
        state.findings = [finding if f is before else f for f in state.findings]
        state.prepared, state.fit = prepared, other
        return True
    return False


def joint_effects_to_replace(state: State) -> list[Term]:
    """Effects of the joint that an effect of the drive may replace."""
    own = state.fit.effects
    of_joint = [t for t in own if isinstance(t, EffectTerm) and not isinstance(t, DriveTerm)]
    named = [t for t in of_joint if not t.effect.first]
    if not (named and state.prepared.commanded):
        return []
    coarse = state.prepared.thinned(COARSE)
    start = refit(coarse, own, state.fit.shape, ROUGH)
    return [
        t
        for t, now in zip(own, start.effects, strict=True)
        if t in named and _promised(coarse, start, now)
    ]


def _promised(coarse: Prepared, start: Fit, term: Term) -> bool:
    """Whether an effect of the drive explains, to first order, much of what another effect
    explains.

    Its change of the torque balance serves as a column.
    """
    rest = refit(coarse, all_but(start.effects, term), start.shape, ROUGH)
    balance = Balance(coarse, rest.shape, rest.terms)
    _, plain = balance.columns(rest.shape, rest.terms)
    candidates = []
    for other in drive_terms(coarse, rest.terms):
        _, driven = balance.columns(rest.shape, (*rest.terms, other))
        if np.any(driven != plain):
            candidates.append(Candidate(other, (plain - driven)[:, None] * rest.gain))
    blocks = make_blocks(coarse, rest)
    seen = screen(rest, blocks, candidates)
    before, now = scored(rest, blocks).total, scored(start, blocks).total
    left = [float(seen.held_out([*seen.terms, at])[0].sum()) for at in seen.candidates]
    return before - min(left, default=before) >= APART * (before - now)
