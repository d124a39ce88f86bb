"""Search for shared causes of a robot's joints.

Fit every joint's law; repeat: screen every shared cause over all joints, accept justified ones, fit
causes and laws together, drop redundant ones; until none is accepted.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY
from frictionjoint.identify.early_checks import scale_is_determined
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.alternatives import simpler, with_alternatives
from frictionjoint.robot.causes.catalogue import all_links, catalogue
from frictionjoint.robot.causes.cause import Cause, Found
from frictionjoint.robot.choose import Choice, choose, redundant
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import Common, columns_of, common_terms
from frictionjoint.robot.compare import nearer
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.settle import Settled
from frictionjoint.robot.shaft_waves import with_waves
from frictionjoint.robot.workers import Each


def shared_causes(
    joints: Sequence[FittedJoint],
    moving: Sequence[str],
    each: Each[FittedJoint, FittedJoint],
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> Settled:
    """The causes in the model, with the joints fitted under them.

    Joints with a torque scale that their logs do not determine are left out.

    Args:
        joints: with their laws fitted with the user's model. moving: joints with logged motion.
        each: a `map`, perhaps over processes. seed: for sign flips and halves.
    """
    rng = np.random.default_rng(seed)
    model = joints[0].alongs[0].model
    known = [j for j in joints if scale_is_determined(j.prepared, j.fit)]
    own = tuple(known or joints)
    now = Settled(Found(Corrections.none(model)), own, Clock(own), each).refitted()
    if not known:
        return now
    names = [j.name for j in known]
    alongs = known[0].alongs
    velocity = {n: np.concatenate([a.motion(n)[1] for a in alongs]) for n in names}
    open_ones = list(catalogue(model, names, moving, velocity))
    whole = all_links(open_ones)
    alike = common_terms(known)
    refused = frozenset[Cause]()
    common: tuple[tuple[Common, Choice], ...] = ()
    simplest: tuple[Settled, frozenset[str]] | None = None
    # sets of effects of single joints that the causes were fitted with
    tried: set[frozenset[str]] = set()
    for turn in range(1, 11):
        progress(f"looking for causes that joints share, round {turn}")
        here = now.found
        possible = [*open_ones, *with_waves(now.joints, here)]
        candidates = [c for c in possible if c not in here.causes and c not in refused]
        looked = screen(now.joints, now.clock, here, candidates, common=alike)
        grown: Settled | None = None
        while grown is None:
            seen = choose(looked, rng, now.joints[0].common_effects)
            new = [c for c in seen if c.candidate.cause is not None]
            labels = frozenset(c.candidate.label for c in seen if not c.candidate.shared)
            with_these = replace(now, single_effects=labels)
            common = _common(looked, seen)
            if not new:
                break
            progress(
                f"causes that joints share, found: {', '.join(c.candidate.label for c in new)}"
            )
            grown = _grown(with_these, new)
            if grown is None:
                refused |= {c.candidate.cause for c in new[:1] if c.candidate.cause}
                looked = looked.without(new[0].candidate)
        if grown is not None:
            now, refused = grown, frozenset()
            tried.clear()
            continue
        if simplest is None or simplest[0] is not now or simplest[1] != labels:
            fewer = _simplified(with_these, open_ones, alike)
            if fewer is not None:
                now = fewer
                tried.clear()
                continue
            simplest = now, labels
        terms = tuple(one.term for one, _ in common)
        if terms != now.joints[0].common_effects:
            # what all joints have alike has bent their laws
            now = _without_redundant(with_these.with_common(terms).refitted())
            continue
        if whole and not common:
            # no single link is wrong by so much; perhaps each is by a little
            open_ones, whole = [*open_ones, *whole], []
            continue
        tried.add(now.single_effects)
        if not here.causes or labels in tried:
            break
        # numbers that were fitted before effects of single joints were seen hold a part of them
        now = with_these.refitted()
    now = replace(now, single_effects=labels)
    choices = with_alternatives(now, open_ones)
    return replace(now.with_covariance(), choices=choices, common=common)


def _common(looked: Screened, seen: Sequence[Choice]) -> tuple[tuple[Common, Choice], ...]:
    """Common effects among those accepted in a step, fitted with all the others."""
    choices = [(c.candidate.common, c) for c in seen if c.candidate.common]
    if not choices:
        return ()
    at = looked.columns(c.candidate for c in seen)
    numbers, cov = looked.stack.solution(at), looked.stack.covariance(at)
    found = []
    for term, choice in choices:
        own = np.flatnonzero(np.isin(at, choice.candidate.at))
        joints = choice.candidate.joints
        found.append((Common(term, joints, numbers[own], cov[np.ix_(own, own)]), choice))
    return tuple(found)


def _grown(now: Settled, new: Sequence[Choice]) -> Settled | None:
    """The state with all accepted causes or the first, whichever is better with refitted laws."""
    for several in [new, new[:1]][: len(new)]:
        trial = _without_redundant(_with(now, several))
        parts = {part for choice in several for part, _ in choice.parts}
        if parts.intersection(trial.found.causes):
            ratios = _left(trial, now)
            if float(ratios.mean()) < 1.0 and float(ratios.max()) < 1.0 + CLEARLY:
                return trial
    return None


def _with(now: Settled, new: Sequence[Choice]) -> Settled:
    """The state with accepted causes; a richer change of a body or joint replaces a simpler."""
    terms = tuple(c.candidate.common for c in new if c.candidate.common)
    if terms:
        now = now.with_common(terms)
    for choice in (c for c in new if c.candidate.cause):
        for part, own in choice.parts:
            same = (i for i, c in enumerate(now.found.causes) if c.changed == part.changed)
            now = now.without(*same).with_cause(choice.of(part), own)
    return now.refitted()


def _simplified(
    now: Settled, causes: Sequence[Cause], common: Sequence[EffectTerm]
) -> Settled | None:
    """The state with a cause replaced by one with fewer numbers that explains as much."""
    for out, several in simpler(now, causes, common):
        trial = _with(now.without(*out), several)
        # fewer numbers leave a joint a little more of the data they are fitted to
        if not _explains_as_much(trial, now):
            continue
        fewer = _without_redundant(trial)
        if fewer is not trial and not _explains_as_much(fewer, now):
            continue
        if not _deviates_more(fewer, now):
            return fewer
    return None


def _explains_as_much(after: Settled, before: Settled) -> bool:
    """Whether causes leave the joints not noticeably more."""
    return float(_left(after, before).mean()) < 1.0 + CLEARLY


def _left(after: Settled, before: Settled) -> Array:
    """Ratio of the sums of squares after and before, with effects of single joints, (J,)."""
    found = []
    for now in (after, before):
        seen = now.screened()
        squares = seen.stack.held_out(columns_of(seen.candidates)).sum(axis=1)
        found.append(squares * [j.left**2 for j in seen.stack.joints])
    return np.asarray(found[0] / found[1])


def _without_redundant(now: Settled) -> Settled:
    """Remove, one after the other, causes without which the robot is predicted as well."""
    while (fewer := _fewer(now)) is not None:
        now = fewer
    return now


def _fewer(now: Settled) -> Settled | None:
    """The state without the least needed cause, or None: after refitting the others, the residual
    must be as small as predicted to first order, and bodies no farther from nominal values."""
    found = now.found
    others = [now.corrected(found.without(i)).screened() for i in range(len(found.causes))]
    for i, promised in redundant(now.screened(), others):
        trial = now.without(i).refitted()
        most = (1.0 + CLEARLY) * max(1.0, float(promised.mean()))
        if not _deviates_more(trial, now) and float(_left(trial, now).mean()) <= most:
            return trial
    return None


def _deviates_more(after: Settled, before: Settled) -> bool:
    """Whether bodies differ noticeably from the model's nominal values."""
    return nearer(before.found.deviation, after.found.deviation)
