"""Joint fit of the numbers of shared causes and the laws of all joints.

The causes' numbers are fitted with every joint's law projected out, then the laws again, until both
converge. Undetermined numbers stay near the model's nominal values.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.causes.cause import Cause, Found
from frictionjoint.robot.choose import Choice
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import Common
from frictionjoint.robot.fit_causes import fitted_causes
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.workers import Each


@dataclass(frozen=True)
class Settled:
    """Causes and laws fitted together.

    Attributes:
        found: the causes. choices: the evidence of each.
        joints: the joints with the laws fitted under these causes. clock: time blocks of them.
        each: a `map` for the fits of the joints, perhaps over processes.
        single_effects: labels of effects of single joints that are fitted too.
        common: effects common to all joints, part of each joint's own model, with their evidence.
        covariance: covariance of the numbers of each cause, from sums over blocks of time, (k, k);
            infinite for numbers that the logs do not determine. As `common`, of the outcome only.
    """

    found: Found
    joints: tuple[FittedJoint, ...]
    clock: Clock
    each: Each[FittedJoint, FittedJoint] = field(repr=False)
    choices: tuple[Choice, ...] = ()
    single_effects: frozenset[str] = frozenset()
    common: tuple[tuple[Common, Choice], ...] = ()
    covariance: tuple[Array, ...] = field(default=(), repr=False)

    def with_cause(self, choice: Choice, numbers: Array) -> "Settled":
        """The state with one more cause, not fitted yet."""
        assert choice.candidate.cause is not None
        found = self.found.with_cause(choice.candidate.cause, numbers)
        return replace(self, found=found, choices=(*self.choices, choice))

    def without(self, *out: int) -> "Settled":
        """The state without some causes, by index, not fitted yet."""
        choices = tuple(c for i, c in enumerate(self.choices) if i not in out)
        return replace(self, found=self.found.without(*out), choices=choices)

    def corrected(self, found: Found) -> "Settled":
        """The same laws in the same blocks, with the joints under other causes."""
        joints = tuple(j.corrected(found.state) for j in self.joints)
        return replace(self, found=found, joints=joints)

    def fitted_with(self, causes: Sequence[Cause]) -> "Settled":
        """The same laws with more causes, fitted together with those in the model."""
        start = self.found
        for cause in causes:
            start = start.with_cause(cause, cause.start)
        own = self.single_effects.__contains__
        return self.corrected(fitted_causes(self.joints, self.clock, start, own))

    def screened(self) -> Screened:
        """Columns of the causes, of effects of single joints, and of common effects in the laws."""
        common, own = self.joints[0].common_effects, self.single_effects.__contains__
        return screen(self.joints, self.clock, self.found, (), own, common)

    def squares_left(self) -> Array:
        """Residual sum of squares by joint and block, (J, B)."""
        seen = self.screened()
        return seen.held_out(seen.candidates)

    def with_common(self, terms: tuple[EffectTerm, ...]) -> "Settled":
        """The same causes, with the laws fitted together with some effects of all joints."""
        before = [replace(j, common_effects=terms) for j in self.joints]
        return replace(self, joints=self._fitted_again(before, FittedJoint.refitted))

    def with_covariance(self) -> "Settled":
        """The same with the covariance, next to the effects of single joints."""
        if not self.found.causes:
            return self
        seen = self.screened()
        cov = seen.stack.covariance(seen.columns(seen.candidates))
        ends = np.cumsum([0, *(len(c.at) for c in seen.accepted)])
        return replace(self, covariance=tuple(cov[a:b, a:b] for a, b in itertools.pairwise(ends)))

    def refitted(self) -> "Settled":
        """Causes and laws fitted together, from the present numbers."""
        found, own = self.found, self.single_effects.__contains__
        now = tuple(j.corrected(found.state) for j in self.joints)
        if not found.causes:
            now = self._fitted_again(now, _followed)
            return replace(self, joints=now, clock=Clock(now))
        for turn in range(4):
            stepped = fitted_causes(now, Clock(now), found, own)
            trial = self._fitted_again([j.corrected(stepped.state) for j in now], _followed)
            # a gain below 0.1% ends the iteration
            ratios = [(a.left / b.left) ** 2 for a, b in zip(trial, now, strict=True)]
            if turn and float(np.mean(ratios)) > 0.999:
                break
            found, now = stepped, trial
        return replace(self, found=found, joints=now, clock=Clock(now))

    def _fitted_again(
        self, joints: Sequence[FittedJoint], how: Callable[[FittedJoint], FittedJoint]
    ) -> tuple[FittedJoint, ...]:
        """Joints fitted again, without cached columns: a result from another process has none."""
        found = self.each(how, joints)
        return tuple(replace(a, alongs=b.alongs) for a, b in zip(found, joints, strict=True))


def _followed(joint: FittedJoint) -> FittedJoint:
    """The law fitted again, from all starts if it may be biased."""
    # to first order the residual holds the shift already; to one below 1% of it a law adapts by
    # less
    if joint.shift is not None and root_mean_square(joint.shift) < 0.01 * joint.rms:
        return joint
    again = joint.refitted()
    # if the causes removed 30% of the squares, the law may be in another minimum
    if again.rms**2 > 0.7 * joint.rms**2:
        return again
    anew = again.refitted(anew=True)
    return anew if anew.rms < again.rms else again
