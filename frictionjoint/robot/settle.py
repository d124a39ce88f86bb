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
from frictionjoint.robot.stack import Columns, least_squares, roots

_T = TypeVar("_T")
_R = TypeVar("_R")
Each = Callable[[Callable[[_T], _R], Iterable[_T]], Iterable[_R]]

# Gauss-Newton steps under laws as they are, and how often the laws follow
_MOST_STEPS, _MOST_LAWS = 6, 4
# parts of a step that are tried where the whole of it leaves more
_SHORTER = (1.0, 0.5, 0.2, 0.05)
# fraction of the squares left that a step must take away to be followed by another one
_SETTLED = 1e-3
# part of a joint's squares from which on the causes have changed it so much that its law is fitted
# from everywhere
_CHANGED = 0.3
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
) -> Settled:
    """Fit causes and laws together.

    Args:
        found: causes with numbers to start from; joints: fitted under whatever.
        each: a `map`, perhaps of processes. beside: labels of effects of single joints that are
            fitted too.
    """
    now = tuple(j.corrected(found.state) for j in joints)
    if not found.causes:
        if any(np.any(j.shift) for j in now if j.shift is not None):
            now = tuple(each(_again, now))
        return Settled(found, now, clock(now))
    before: tuple[FittedJoint, ...] | None = None
    for _ in range(_MOST_LAWS):
        stepped = _descended(now, found, beside)
        trial = tuple(each(_followed, [j.corrected(stepped.state) for j in now]))
        if before is not None and _cost(trial, before) > 1.0 - _SETTLED:
            break
        found, now, before = stepped, trial, trial
    seen = screened(now, clock(now), found, beside)
    return Settled(found, now, seen.stack.clock, _covariances(seen))


def _descended(joints: Sequence[FittedJoint], found: Found, beside: frozenset[str]) -> Found:
    """Numbers by Gauss-Newton, the laws moving along to first order."""
    blocks = clock(joints)
    seen = screened([j.corrected(found.state) for j in joints], blocks, found, beside)
    merit = _merit(found, seen)
    for _ in range(_MOST_STEPS):
        step = _step(seen)
        for part in _SHORTER:
            trial = _moved(found, part * step)
            at = [j.corrected(trial.state) for j in joints]
            after = screened(at, blocks, trial, beside)
            reached = _merit(trial, after)
            if reached < merit:
                break
        else:
            break
        taken = 1.0 - reached / merit
        found, seen, merit = trial, after, reached
        if taken < _SETTLED:
            break
    return found


def _merit(found: Found, seen: Screened) -> float:
    """Squares left with the laws and single joints' effects moving along, and what is presumed."""
    G = seen.stack.total
    at = _all([c.at for c in seen.candidates])
    taken = float(G[at, -1] @ least_squares(G[np.ix_(at, at)], G[at, -1]))
    pairs = zip(found.causes, found.numbers, strict=True)
    presumed = sum(float(np.sum((x / c.prior) ** 2)) for c, x in pairs)
    return float(G[-1, -1]) - taken + presumed


def _followed(joint: FittedJoint) -> FittedJoint:
    """The law fitted again, from everywhere where it may have been bent."""
    again = joint.refitted()
    if again.fit.rms**2 > (1.0 - _CHANGED) * joint.fit.rms**2:
        return again
    anew = again.refitted(anew=True)
    return anew if anew.fit.rms < again.fit.rms else again


def _again(joint: FittedJoint) -> FittedJoint:
    return joint.refitted()


def screened(
    joints: Sequence[FittedJoint], blocks: Clock, found: Found, beside: frozenset[str]
) -> Screened:
    """Columns of the causes in the model and of some effects of single joints, by label."""
    return screen(joints, blocks, found, (), lambda label: label in beside)


def _cost(trial: Sequence[FittedJoint], now: Sequence[FittedJoint]) -> float:
    """Squares left over those left before, joints counted alike."""
    return float(np.mean([(a.fit.rms / b.fit.rms) ** 2 for a, b in zip(trial, now, strict=True)]))


def _step(seen: Screened) -> Array:
    """Change of all causes' numbers, one after the other."""
    own = _all([c.at for c in seen.taken])
    also = _all([c.at for c in seen.candidates])
    at = np.concatenate([own, also])
    low, high = (np.concatenate([c.room[:, k] for c in seen.taken]) for k in (0, 1))
    G = seen.stack.total
    free = np.full(len(also), np.inf)
    low, high = np.concatenate([low, -free]), np.concatenate([high, free])
    return _bounded(G[np.ix_(at, at)], G[at, -1], low, high)[: len(own)]


def _moved(found: Found, step: Array) -> Found:
    ends = np.cumsum([len(n) for n in found.numbers])
    parts = np.split(step, ends[:-1])
    return replace(
        found, numbers=tuple(n + part for n, part in zip(found.numbers, parts, strict=True))
    )


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
