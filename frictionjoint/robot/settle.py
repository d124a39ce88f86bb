"""Numbers of shared causes and the laws of all joints, fitted together.

Gauss-Newton over the causes' numbers with every joint's law projected out, then the laws again,
until neither moves. What the logs do not determine stays near the model's own figures.
"""

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array
from frictionjoint.robot.clock import Clock, clock
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.screen import Candidate, Found, Screened, screen
from frictionjoint.robot.stack import Columns, roots

_T = TypeVar("_T")
_R = TypeVar("_R")
Each = Callable[[Callable[[_T], _R], Iterable[_T]], Iterable[_R]]

_MOST_STEPS = 6
# fraction of the squares left that a step must take away to be followed by another one
_SETTLED = 1e-3
# of the largest eigenvalue, below which a direction of the numbers is not determined, and its part
# in a number from which on that is not
_DETERMINED, _OPEN = 1e-8, 1e-4


@dataclass(frozen=True)
class Settled:
    """Causes and laws that fit each other.

    Attributes:
        found: the causes. joints: with their laws fitted under them. clock: their blocks.
        covariance: of each cause's numbers, by sums over blocks of time, (k, k); infinite where
            the logs do not determine a number.
    """

    found: Found
    joints: tuple[FittedJoint, ...]
    clock: Clock
    covariance: tuple[Array, ...] = field(default=(), repr=False)


def settle(
    joints: Sequence[FittedJoint],
    found: Found,
    each: Each[FittedJoint, FittedJoint],
    beside: frozenset[str] = frozenset(),
    anew: bool = False,
) -> Settled:
    """Fit causes and laws together.

    Args:
        found: causes with numbers to start from; joints: fitted under whatever.
        each: a `map`, perhaps of processes. beside: labels of effects of single joints that are
            fitted too. anew: first refit the laws from all starts, for they may be distorted.
    """
    if not found.causes:
        return Settled(found, tuple(joints), clock(joints))
    now = _refitted(joints, found, each, anew)
    seen = _screened(now, found, beside)
    for _ in range(_MOST_STEPS):
        stepped, taken = _stepped(found, seen)
        if taken < _SETTLED:
            break
        trial = _refitted(now, stepped, each, False)
        after = _screened(trial, stepped, beside)
        if _cost(trial, now) > 1.0:
            break
        found, now, seen = stepped, trial, after
    return Settled(found, now, seen.stack.clock, _covariances(seen))


def _refitted(
    joints: Sequence[FittedJoint], found: Found, each: Each[FittedJoint, FittedJoint], anew: bool
) -> tuple[FittedJoint, ...]:
    state = found.state
    again = [j.corrected(state) for j in joints]
    return tuple(each(_anew if anew else _again, again))


def _anew(joint: FittedJoint) -> FittedJoint:
    return joint.refitted(anew=True)


def _again(joint: FittedJoint) -> FittedJoint:
    return joint.refitted()


def _screened(joints: Sequence[FittedJoint], found: Found, beside: frozenset[str]) -> Screened:
    return screen(joints, clock(joints), found, (), lambda label: label in beside)


def _cost(trial: Sequence[FittedJoint], now: Sequence[FittedJoint]) -> float:
    """Squares left over those left before, joints counted alike."""
    return float(np.mean([(a.fit.rms / b.fit.rms) ** 2 for a, b in zip(trial, now, strict=True)]))


def _stepped(found: Found, seen: Screened) -> tuple[Found, float]:
    """The next numbers, and the fraction of the squares that they should take away."""
    own = _all([c.at for c in seen.taken])
    also = _all([c.at for c in seen.candidates])
    at = np.concatenate([own, also])
    low, high = (np.concatenate([c.room[:, k] for c in seen.taken]) for k in (0, 1))
    G = seen.stack.total
    A, b = G[np.ix_(at, at)], G[at, -1]
    free = np.full(len(also), np.inf)
    step = _bounded(A, b, np.concatenate([low, -free]), np.concatenate([high, free]))
    # what effects of single joints explain does not show whether the causes have settled
    moved = step[: len(own)]
    taken = 2.0 * moved @ b[: len(own)] - moved @ A[: len(own), : len(own)] @ moved
    if len(also):
        taken -= 2.0 * moved @ A[: len(own), len(own) :] @ step[len(own) :]
    ends = np.cumsum([len(n) for n in found.numbers])
    parts = np.split(moved, ends[:-1])
    numbers = tuple(n + part for n, part in zip(found.numbers, parts, strict=True))
    return replace(found, numbers=numbers), float(taken) / float(G[-1, -1])


def _bounded(A: Array, b: Array, low: Array, high: Array) -> Array:
    """Least squares by normal equations between bounds."""
    scale = roots(A)
    values, vectors = np.linalg.eigh(A / np.outer(scale, scale))
    kept = values > 1e-10 * values[-1]
    root = np.sqrt(values[kept])
    X = root[:, None] * vectors[:, kept].T
    y = (vectors[:, kept].T @ (b / scale)) / root
    # a number may start on its bound: a hair of room either way
    room = 1e-12
    found = lsq_linear(X, y, (low * scale - room, high * scale + room), method="bvls")
    return np.asarray(np.clip(found.x / scale, low, high))


def _covariances(seen: Screened) -> tuple[Array, ...]:
    """Of each cause's numbers: blocks of time are independent, samples are not."""
    own = [c.at for c in seen.taken]
    at = _all([*own, *(c.at for c in seen.candidates)])
    G = seen.stack.presumed_apart(at)
    scale = roots(G)
    values, vectors = np.linalg.eigh(G / np.outer(scale, scale))
    determined = values > _DETERMINED * values[-1]
    inverse = (vectors[:, determined] / values[determined]) @ vectors[:, determined].T
    scores = seen.stack.scores(at, np.zeros(0, dtype=np.int64)) / scale
    blocks = len(scores)
    spread = scores.T @ scores * blocks / max(1, blocks - len(at))
    cov = (inverse @ spread @ inverse) / np.outer(scale, scale)
    open_ones = np.sum(vectors[:, ~determined] ** 2, axis=1) > _OPEN
    cov[open_ones, open_ones] = np.inf
    ends = np.cumsum([0, *(len(a) for a in own)])
    return tuple(cov[a:b, a:b] for a, b in itertools.pairwise(ends))


def _all(parts: Sequence[Columns]) -> Columns:
    return np.concatenate([*parts, []]).astype(np.int64)


def numbers_of(candidate: Candidate, numbers: Array, start: Array) -> Array:
    """All numbers of a cause whose candidate may lack those that its bounds hold.

    Args:
        numbers: of the candidate's columns, in turn.
    """
    x = start.copy()
    x[candidate.at - candidate.first] = numbers
    return x
