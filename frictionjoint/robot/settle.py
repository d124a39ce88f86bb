"""Joint fit of the numbers of shared causes and the laws of all joints.

The causes' numbers are fitted with every joint's law projected out, then the laws again, until both
converge. Undetermined numbers stay near the model's nominal values.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.candidate import Candidate, columns_of
from frictionjoint.robot.clock import Clock, clock
from frictionjoint.robot.descend import descended
from frictionjoint.robot.found import Found
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Screened, screen
from frictionjoint.robot.stack import Columns, Stack, roots
from frictionjoint.robot.workers import Each


@dataclass(frozen=True)
class Settled:
    """Causes and laws fitted together.

    Attributes:
        found: the causes. joints: the joints with the laws fitted under these causes.
        clock: time blocks of the joints.
        covariance: covariance of the numbers of each cause, from sums over blocks of time, (k, k);
            infinite for numbers that the logs do not determine. Of the final causes only.
    """

    found: Found
    joints: tuple[FittedJoint, ...]
    clock: Clock
    covariance: tuple[Array, ...] = field(default=(), repr=False)

    def with_covariance(self, single_effects: frozenset[str]) -> "Settled":
        """The same with the covariance, next to some effects of single joints, by label."""
        if not self.found.causes:
            return self
        seen = screened(self.joints, self.clock, self.found, single_effects)
        cov = covariance(seen.stack, columns_of((*seen.accepted, *seen.candidates)))
        ends = np.cumsum([0, *(len(c.at) for c in seen.accepted)])
        return replace(self, covariance=tuple(cov[a:b, a:b] for a, b in itertools.pairwise(ends)))


def settle(
    joints: Sequence[FittedJoint],
    found: Found,
    each: Each[FittedJoint, FittedJoint],
    single_effects: frozenset[str] = frozenset(),
) -> Settled:
    """Fit causes and laws together.

    Args:
        found: causes with starting numbers; joints: fitted under any corrections.
        each: a `map`, perhaps over processes.
        single_effects: labels of effects of single joints to fit too.
    """
    now = tuple(j.corrected(found.state) for j in joints)
    if not found.causes:
        now = _fitted_again(now, _followed, each)
        return Settled(found, now, clock(now))
    before: tuple[FittedJoint, ...] | None = None
    for _ in range(4):
        stepped = descended(now, clock(now), found, lambda label: label in single_effects)
        trial = _fitted_again([j.corrected(stepped.state) for j in now], _followed, each)
        if before is not None:
            ratios = [(a.rms / b.rms) ** 2 for a, b in zip(trial, before, strict=True)]
            if float(np.mean(ratios)) > 0.999:  # a gain below 0.1% ends the iteration
                break
        found, now, before = stepped, trial, trial
    return Settled(found, now, clock(now))


def _fitted_again(
    joints: Sequence[FittedJoint],
    how: Callable[[FittedJoint], FittedJoint],
    each: Each[FittedJoint, FittedJoint],
) -> tuple[FittedJoint, ...]:
    """Joints fitted again, without cached columns: a result from another process has none."""
    found = each(how, joints)
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


def fitted_with_common(
    joints: Sequence[FittedJoint],
    terms: tuple[EffectTerm, ...],
    each: Each[FittedJoint, FittedJoint],
) -> tuple[FittedJoint, ...]:
    """Joints with their laws fitted together with some effects."""
    return _fitted_again(
        [replace(j, common_effects=terms) for j in joints], FittedJoint.refitted, each
    )


def screened(
    joints: Sequence[FittedJoint], blocks: Clock, found: Found, single_effects: frozenset[str]
) -> Screened:
    """Columns of the causes in the model, of some effects of single joints by label, and of the
    common effects that were fitted with the laws.
    """
    return screen(joints, blocks, found, (), single_effects.__contains__, joints[0].common_effects)


def squares_left(
    joints: Sequence[FittedJoint], blocks: Clock, found: Found, single_effects: frozenset[str]
) -> Array:
    """Residual sum of squares by joint and block with causes and some effects of joints, (J, B)."""
    seen = screened(joints, blocks, found, single_effects)
    return seen.stack.held_out(columns_of((*seen.accepted, *seen.candidates)))


def covariance(stack: Stack, at: Columns) -> Array:
    """Covariance of coefficients fitted together, (k, k); blocks of time are independent,
    samples not."""
    G = stack.presumed_apart(at)
    scale = roots(G)
    values, vectors = eigh(G / np.outer(scale, scale))
    # directions of smaller eigenvalues are undetermined, and numbers that contain them
    determined = values > 1e-8 * values[-1]
    inverse = (vectors[:, determined] / values[determined]) @ vectors[:, determined].T
    scores = stack.products(at, np.zeros(0, dtype=np.int64))[1] / scale
    blocks = len(scores)
    spread = scores.T @ scores * blocks / max(1, blocks - len(at))
    cov = (inverse @ spread @ inverse) / np.outer(scale, scale)
    open_ones = np.sum(vectors[:, ~determined] ** 2, axis=1) > 1e-4
    cov[open_ones, open_ones] = np.inf
    return np.asarray(cov)


def numbers_of(candidate: Candidate, numbers: Array, start: Array) -> Array:
    """All numbers of a cause, including those that stay on their bounds and are no columns.

    Args:
        numbers: of the candidate's columns, in order.
    """
    x = start.copy()
    x[candidate.at - candidate.first] = numbers
    return x
