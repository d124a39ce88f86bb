"""The next motion to record: the shortest one expected to determine what the logs cannot."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.advice import loose_parameters
from frictionjoint.diagnose.candidate import columns_of, signals_of
from frictionjoint.diagnose.motion_as_log import Carried, payload_of, prepared_motion
from frictionjoint.diagnose.motions import (
    DURATIONS,
    Limits,
    Motion,
    between,
    family,
    least_travel,
    sampling,
    seen,
    wider,
)
from frictionjoint.diagnose.separation import (
    Effect,
    Noise,
    Separation,
    moments,
    separation,
    with_further,
)
from frictionjoint.effects.catalogue import title
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import Estimate, is_without_level, law_estimates, law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.sensitivity import driven, sensitivities
from frictionjoint.identify.terms import Term
from frictionjoint.parameter_meanings import meanings

_DEVIATIONS, _SHARE = 3.0, 0.04


@dataclass(frozen=True)
class Proposal:
    """A recording to make."""

    motion: Motion  # cut to the proposed duration
    # evidence with this recording, if the first effect is true and if the second is
    expected: tuple[Separation, Separation]
    now: tuple[Separation, Separation]  # evidence from the present logs

    @property
    def distinguishes(self) -> bool:
        """Whether it is expected to resolve the tie, whichever effect is true."""
        return _part(self.expected) >= 1.0

    @property
    def nested(self) -> bool:
        """Whether the second effect contains the first one as a special case."""
        first, second = self.expected
        return first.share < 1e-4 <= second.share


class Planner:
    """The logs and their fit, used to plan the next recording.

    Args:
        prepared: the fitted logs. fitted: with all effects found.
        body: of the MJCF that the logs were prepared with.
    """

    def __init__(self, prepared: Prepared, fitted: Fit, body: RigidBody) -> None:
        self.prepared = prepared
        self.fitted = fitted
        self.body = body
        self.limits = seen(prepared, body)
        self.blocks = make_blocks(prepared, fitted).count
        self.noise = Noise(fitted.residual, fitted.log_index, self.blocks)
        law = law_parameters(fitted)
        self.presliding = fitted.coefficient("Fc") / law.stiffness if law.stiffness else 0.0
        self._tried: dict[Limits, list[tuple[Motion, Prepared, Array]]] = {}

    def distinguishing(self, i: int, other: Term) -> Proposal | None:
        """The shortest recording expected to distinguish term i of the fit from another term.

        It stays within the range of the logs if that is sufficient. If no motion suffices, it is
        the one that comes nearest (see `Proposal.distinguishes`); None if no motion can be tried.
        """
        J, own = self.fitted.jacobian, self.fitted.layout.of_term(i)
        term = self.fitted.terms[i]
        of_delay = np.array(term.shape)
        effect = Effect(term, self.fitted.term_coefficients(i) if term.coefficients else of_delay)
        law = np.flatnonzero(~self.fitted.bound & ~np.isin(np.arange(J.shape[1]), own))
        rival = self._rival(effect, other, J[:, law])
        both = effect, rival
        columns = [x.columns(self.prepared, self.fitted) for x in both]
        here = np.column_stack([J[:, law], *columns])
        logs = [self.fitted.log_index == i for i in np.unique(self.fitted.log_index)]
        first, *others = (moments(here[one], self.noise) for one in logs)
        old = sum(others, first)
        sizes = (len(law), effect.size, rival.size)
        now = separation(old, *sizes)
        best: Proposal | None = None
        beyond = wider(self.limits, self.body)
        # the least effort first
        for limits, loaded in itertools.product((self.limits, beyond), (False, True)):
            noise = self._noise(limits)
            for motion, prepared, sensitive in self._motions(limits):
                if loaded != (motion.payload > 0.0):
                    continue
                columns = [x.columns(prepared, self.fitted) for x in both]
                U = np.column_stack([sensitive[:, law], *columns])
                for duration in _durations(motion):
                    if best is not None and best.distinguishes and duration > best.motion.duration:
                        break
                    rows = round(duration / motion.duration * len(U))
                    expected = separation(old + moments(U[:rows], noise), *sizes)
                    trial = Proposal(motion.part(duration), expected, now)
                    best = trial if best is None else max(best, trial, key=_worth)
                    if trial.distinguishes:
                        break
            if best is not None and (best.distinguishes or best.nested):
                break
        return best

    def sharpening(
        self, cov: Array, names: Sequence[str], law: Mapping[str, Estimate]
    ) -> tuple[Motion, dict[str, Estimate]] | None:
        """The recording that determines most of some parameters, and determines them best.

        Args:
            cov: of all parameters of the fit. names: of the law's parameters to determine.
            law: their present estimates.
        Returns:
            its motion, and the estimates expected with it; None if none determines any of them.
        """
        best, most = None, (0, 0.0)
        noise = self._noise(self.limits)
        for motion, _, sensitive in self._motions(self.limits):
            enough = [x for x in _durations(motion) if x >= 40.0]
            part = motion.part(enough[0] if enough else motion.duration)
            rows = round(part.duration / motion.duration * len(sensitive))
            further = moments(sensitive[:rows], noise)
            expected = with_further(cov, self.fitted.jacobian, further)
            found = law_estimates(self.fitted, expected, self.body.slide)
            ratios = {name: _ratio(found[name], law[name]) for name in names}
            # a standard error that falls by 30% is worth a record
            gained = [n for n, ratio in ratios.items() if ratio < 0.7 and is_known(found[n])]
            worth = (len(gained), -max((ratios[n] for n in gained), default=0.0))
            if worth > most:
                best, most = (part, {n: found[n] for n in gained}), worth
        return best

    def _rival(self, effect: Effect, other: Term, law: Array) -> Effect:
        """The other effect, with the coefficients it would have instead of the first one."""
        signals = signals_of(self.prepared, self.fitted)
        target = self.fitted.residual
        target = target + effect.columns(self.prepared, self.fitted)[:, -1]
        X = columns_of(self.prepared, signals, other)
        both = np.column_stack([law, X])
        solved = np.linalg.lstsq(both, target, rcond=1e-10)[0]
        return Effect(other, np.asarray(solved[law.shape[1] :]))

    def _noise(self, limits: Limits) -> Noise:
        every = sampling(limits, self.prepared)
        return Noise(self.fitted.residual, self.fitted.log_index, self.blocks, every)

    def _motions(self, limits: Limits) -> list[tuple[Motion, Prepared, Array]]:
        """Motions within given limits, with the sensitivities of the fit along each."""
        if limits not in self._tried:
            found = []
            carried = Carried(self.body, self.prepared, limits)
            for motion in family(limits, self.prepared, self.presliding):
                prepared = prepared_motion(motion, self.prepared, carried)
                if prepared.segments[0].kept.any():
                    prepared = driven(prepared, self.fitted)
                    found.append((motion, prepared, sensitivities(prepared, self.fitted)))
            self._tried[limits] = found
        return self._tried[limits]


def _part(both: tuple[Separation, Separation]) -> float:
    """Part of what distinguishes two effects, whichever is true: three standard deviations, and 4%
    of an effect, which no refit makes up for."""
    return min(min(x.deviations / _DEVIATIONS, x.share / _SHARE) for x in both)


def _durations(motion: Motion) -> list[float]:
    """Durations to try, s: at least one whole motion, if the time suffices."""
    tried = [x for x in DURATIONS if motion.once <= x <= motion.duration]
    return tried or [motion.duration]


def _worth(x: Proposal) -> tuple[bool, float, float, float]:
    """Sort key: recordings that distinguish first, then the shorter or the nearer one."""
    shortness = -x.motion.duration if x.distinguishes else 0.0
    return x.distinguishes, shortness, _part(x.expected), max(y.share for y in x.expected)


def is_known(x: Estimate) -> bool:
    """Whether a standard error is informative: at most the value itself."""
    return x.stderr is not None and x.stderr <= abs(x.value)


def _ratio(new: Estimate, old: Estimate) -> float:
    """Ratio of two standard errors; 0 if only the old one is unknown."""
    if new.stderr is None:
        return float("inf")
    return 0.0 if old.stderr is None else new.stderr / old.stderr if old.stderr else float("inf")


def computed_proposals(
    planner: Planner, ties: Sequence[tuple[int, Term]], cov: Array, law: Mapping[str, Estimate]
) -> dict[tuple[str, ...], str]:
    """One sentence per tie, and per group of poorly determined parameters, by their names.

    Args:
        ties: the index of a term of the fit, and an effect that the logs do not distinguish from
            it.
        cov: of all parameters of the fit. law: estimates of its parameters.
    """
    # without motion, speeds taken from the logs would be noise
    if 2.0 * planner.limits.reach <= least_travel(planner.prepared):
        return {
            ("at rest",): "In these logs the joint moves no more than the noise of its position: "
            "record motion."
        }
    found: dict[tuple[str, ...], str] = {}
    for i, other in ties:
        pair = planner.fitted.terms[i].name, other.name
        if pair not in found:  # the first of several terms of one name is the nearest
            found[pair] = to_distinguish(planner, i, other) or ""
    # of a friction that the fit does not contain nothing can be computed
    for _, names in [] if is_without_level(law) else loose_parameters(law):
        found[names] = to_sharpen(planner, cov, names, law)
    return {names: text for names, text in found.items() if text}


def to_distinguish(planner: Planner, i: int, other: Term) -> str | None:
    """What to record to distinguish term i of the fit from another effect, in one sentence.

    None if these logs distinguish them already, or if the other effect contains this one as a
    special case: no recording can rule that out.
    """
    term = planner.fitted.terms[i]
    found = planner.distinguishing(i, other)
    if found is not None and (found.nested or _part(found.now) >= 1.0):
        return None
    names = f"{title(term.name)} from {title(other.name)}"
    if found is None or not found.distinguishes:
        said = "" if found is None else f": at best they differ by {_strength(found.expected)}"
        words = [t.effect.separating_motion for t in (term, other)]
        return (
            f"No motion up to twice the speed of these logs is expected to distinguish {names}"
            f"{said}. Instead: {'; or '.join(dict.fromkeys(words))}."
        )
    return (
        f"To distinguish {names}: {described(found.motion, planner)}. The two should then differ "
        f"by {_strength(found.expected)}; in these logs they differ by {_strength(found.now)}. "
        f"At least {_SHARE:.0%} and {_DEVIATIONS:.0f} standard deviations are needed, because a "
        "smaller difference can be an error of the law."
    )


def to_sharpen(
    planner: Planner, cov: Array, names: Sequence[str], law: Mapping[str, Estimate]
) -> str:
    """What to record to determine some of the law's parameters, in one sentence."""
    found = planner.sharpening(cov, names, law)
    if found is None:
        return (
            f"No motion within the range of these logs is expected to determine {meanings(names)}."
        )
    motion, expected = found
    errors = []
    for name, x in expected.items():
        was = f"{law[name].stderr:.2g}" if is_known(law[name]) else "more than its value"
        unit = "" if x.unit == "1" else f" {x.unit}"
        errors.append(f"{meanings([name])} from {was} to {x.stderr:.2g}{unit}")
    return (
        f"To reduce the standard error of {', '.join(errors)} (computed): "
        f"{described(motion, planner)}."
    )


def described(motion: Motion, planner: Planner) -> str:
    """A motion for people: joint, path, range, speed, load and duration."""
    unit = "m" if planner.body.slide else "rad"
    q = motion.position
    text = (
        f"joint {planner.body.joint!r}, {motion.name}, {between(q.min(), q.max(), unit)}, "
        f"up to {motion.speed:.2g} {unit}/s, "
    )
    load = "loaded as in the logs"
    if motion.payload:
        payload = payload_of(motion, planner.body)
        # the loop takes one MJCF for all logs
        load = f"with a further {payload} (add it to the MJCF of that run)"
    text += f"{load}, for {motion.duration:.0f} s"
    return text + (f" (beyond what was logged: {motion.beyond})" if motion.beyond else "")


def _strength(both: tuple[Separation, Separation]) -> str:
    share, deviations = min(x.share for x in both), min(x.deviations for x in both)
    return f"{share:.1%} of the effect ({deviations:.1f} standard deviations)"
