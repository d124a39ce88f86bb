"""One joint's logs with all that is no decision fixed: law, weights, initial states, time offset.

The law's columns are fitted with a prior on their coefficients, which stands as extra rows below
the data. Every candidate is then looked at with the law's columns taken out, `Experiment.out`.
Of a voltage or a current the gain is not known: the load is one more column, without a prior.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import qr
from scipy.optimize import isotonic_regression

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.signals import LOAD, MOTOR, RATE, H, Q, V
from frictionjoint.identify.blocks import _kinds, correlation_time
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.timing import TargetTiming
from linear_search.decisions import LAW_ERROR
from linear_search.law_basis import LawBasis

# turns in which law and weights settle; the last only solves under the weights of the one before
_TURNS = 4
# blocks of time; logs from which on a fold is a log
_BLOCKS, _LOGS = 60, 3
# samples of a log up to which a time offset is one of sampling, and no effect
_OF_SAMPLING = 0.9
# local stiffness over level per travel at which a sample counts as sticking
_STICKING = 1e3
# sticking below and above which samples tell the error in sliding and at rest
_SLIDES, _STICKS = 0.05, 0.5
# classes of samples alike in sticking, whose errors are averaged; fewest samples of an average
_CLASSES, _FEWEST = 30, 50
# level over the torque's rms that friction is taken to have at least
_LEAST_LEVEL = 1e-3
# blocks of independent samples that the logs are taken to hold at least
_INDEPENDENT = 200
# part of a drive that a controller made that errs as a friction law does
_AS_FRICTION = 0.5
# samples by which a target is moved to see what that changes
_LATER = 0.5
# what is as good as nothing; what keeps a Gram matrix of columns of length 1 regular
_NONE, _REGULAR = 1e-12, 1e-10


@dataclass(frozen=True)
class Blocks:
    """Stretches of time, and which of them are one kind of motion.

    Attributes:
        edges: first sample of each, shape (B,). of_sample: shape (n,).
        fold: log, or kind of motion, of each block, shape (B,). log: of each sample, shape (n,).
    """

    edges: Index
    of_sample: Index
    fold: Index
    log: Index

    @classmethod
    def of(cls, prepared: Prepared) -> "Blocks":
        """Cut logs into blocks that cross no log."""
        counts = [int(s.kept.sum()) for s in prepared.segments]
        log = np.repeat(np.arange(len(counts)), counts)
        in_time = np.arange(len(log)) * _BLOCKS // len(log)
        of_sample = np.unique(in_time * len(counts) + log, return_inverse=True)[1]
        edges = np.flatnonzero(np.diff(of_sample, prepend=-1))
        of_sample = np.cumsum(np.diff(of_sample, prepend=of_sample[0]) != 0)
        fold = log[edges] if len(counts) >= _LOGS else _kinds(prepared, of_sample)
        return cls(edges, of_sample, fold, log)

    def sums(self, x: Array) -> Array:
        """Over the samples of each block, shape (B, ...)."""
        return np.asarray(np.add.reduceat(x, self.edges, axis=0))


@dataclass(frozen=True)
class Experiment:
    """What the search works on.

    Attributes:
        prepared: the logs. basis: of the law. blocks: of time.
        target: drive, less the rigid body's torque where its gain is known, kept samples of all
            logs, shape (n,).
        weight: of each sample, relative to sliding, shape (n,).
        level: friction in motion, in units of the drive; viscous: the same per rad/s (m/s).
        gain: of the drive per N m of the load.
        torque: of the motor, load and friction, N m, shape (n,).
        law: torque of the law without viscous friction along each log over `level`, shape (m,).
        coefficients: of the law's columns, see `LawBasis.columns`.
        offset_is_of_sampling: whether the time between drive and position is within a sample.
        orthonormal: basis of the law's weighted columns with the rows of the prior, shape (n + m,
            m). residual: the target without them, weighted, with the prior's rows, shape (n + m,).
        friction: root of the weighted squares of what errors are compared with: of the friction.
    """

    prepared: Prepared
    basis: LawBasis
    blocks: Blocks
    target: Array = field(repr=False)
    weight: Array = field(repr=False)
    level: float
    viscous: float
    gain: float
    torque: Array = field(repr=False)
    law: tuple[Array, ...] = field(repr=False)
    coefficients: Array = field(repr=False)
    offset_is_of_sampling: bool
    orthonormal: Array = field(repr=False)
    residual: Array = field(repr=False)
    friction: float

    @property
    def sample(self) -> float:
        """Longest time between the samples of a log, s."""
        return max(s.sample for s in self.prepared.segments)

    @cached_property
    def signals(self) -> list[Array]:
        """Signals of each log under the linear law."""
        found = []
        for s, h in zip(self.prepared.segments, self.law, strict=True):
            signals = s.signals.copy()
            signals[:, H], signals[:, RATE] = h, 0.0
            friction = self.level * h + self.viscous * signals[:, V]
            signals[:, MOTOR] = signals[:, LOAD] + friction / self.gain
            found.append(signals)
        return found

    def out(self, x: Array) -> Array:
        """Weighted columns without what the law holds, with the prior's rows, shape (n + m, k)."""
        return _out(self.orthonormal, x * self.weight[:, None])


def _out(orthonormal: Array, x: Array) -> Array:
    rows = np.empty((len(orthonormal), x.shape[1]))
    held = orthonormal[: len(x)].T @ x
    np.matmul(orthonormal, -held, out=rows)
    rows[: len(x)] += x
    return rows


def experiment(
    prepared: Prepared,
    beside: Array | None = None,
    delayed: bool = False,
    before: Experiment | None = None,
) -> Experiment:
    """Fit the law's columns, and settle level, weights and time offset by what they leave.

    Args:
        beside: columns of effects that may be there, N m, shape (n, k): weights that are settled
            beside all of them favour none.
        delayed: one of these is a delay, so that no time offset of sampling is left.
        before: an experiment on the same logs.
    """
    basis = before.basis if before else LawBasis(prepared)
    blocks = before.blocks if before else Blocks.of(prepared)
    load = prepared.balanced_load
    # a known gain is 1
    free = [load] if prepared.gain_unknown else []
    target = prepared.balanced_drive - (0.0 if free else load)
    X, spread = basis.columns
    count = X.shape[1]
    sample = max(s.sample for s in prepared.segments)
    times = _times(prepared)
    X = np.column_stack([X, *free, *times])
    at = X.shape[1] - len(times)
    E = beside if beside is not None else np.zeros((len(target), 0))

    weight = np.ones(len(target))
    level = float(np.std(target))
    error, independent = LAW_ERROR * level, 1.0
    within = np.ones(len(times), dtype=bool)
    for turn in range(_TURNS):
        # the priors of times are in seconds, all others are over the level
        of_times = np.where(within, 0.5 * sample, _NONE)
        priors = np.concatenate([spread * level, np.full(len(free), np.inf), of_times])
        rows = error * np.sqrt(independent) / priors
        b, sizes = _fitted(X, E, target, weight, rows)
        left = target - X @ b - E @ sizes
        law = b[: basis.size].copy()
        law[basis.size - basis.viscous :] = 0.0
        torque = [x @ law for x in basis.along]
        least = _LEAST_LEVEL * float(np.sqrt(np.mean(target**2)))
        level = max(float(np.median(np.abs(np.concatenate(torque)))), least)
        if turn == _TURNS - 1:
            break
        weight = _weights(prepared, torque, level, left)
        error = float(np.sqrt(np.mean((left * weight) ** 2)))
        alike = [correlation_time((left * weight)[blocks.log == i]) for i in np.unique(blocks.log)]
        independent = min(float(np.median(alike)), len(left) / _INDEPENDENT)
        if turn == _TURNS - 3:  # beyond a sample a time offset is an effect
            within = np.abs(b[at:]) < _OF_SAMPLING * sample
            within[0] &= not delayed
    gain = max(float(b[count]), _NONE) if free else 1.0
    friction = X[:, :count] @ b[:count]
    size = float(np.linalg.norm(friction * weight))
    if prepared.commanded:  # what a controller made is not known better than to a part of itself
        taken = X @ b if free else X @ b + load
        size = max(size, _AS_FRICTION * float(np.linalg.norm(taken * weight)))
    weighted = np.vstack([X * weight[:, None], np.diag(rows)])
    orthonormal, _ = qr(weighted / np.linalg.norm(weighted, axis=0), mode="economic")
    return Experiment(
        prepared=prepared,
        basis=basis,
        blocks=blocks,
        target=target,
        weight=weight,
        level=level,
        viscous=float(b[basis.size - 1]) if basis.viscous else 0.0,
        gain=gain,
        torque=load + friction / gain,
        law=tuple(x / level for x in torque),
        coefficients=b,
        offset_is_of_sampling=bool(within[0]),
        orthonormal=orthonormal,
        residual=_out(orthonormal, (target * weight)[:, None])[:, 0],
        friction=size,
    )


def _times(prepared: Prepared) -> list[Array]:
    """What times that are known to a sample change of the drive, per s, shape (n,) each.

    When a measured drive was read, or when a target acts; and the age of a velocity that damps.
    """
    (whole,) = prepared.bundles(1)
    if not prepared.commanded:
        return [np.concatenate([s.balanced_drive(0.0, 1)[s.kept] for s in prepared.segments])]
    sample = min(s.sample for s in prepared.segments)
    late = whole.changed([TargetTiming(sample, (_LATER * sample,)).change])
    of_target = (whole.balanced(whole.driven) - whole.balanced(late)) / (_LATER * sample)
    return [of_target, *([-whole.damping_rate([])] if prepared.damped else [])]


def _fitted(X: Array, E: Array, target: Array, weight: Array, rows: Array) -> tuple[Array, Array]:
    """Coefficients of the law's columns, with the rows of their prior, and of others, without."""
    both = np.column_stack([X, E]) * weight[:, None]
    prior = np.append(rows, np.zeros(E.shape[1]))
    length = np.sqrt(np.sum(both**2, axis=0) + prior**2)
    length[length == 0.0] = 1.0
    both /= length
    gram = both.T @ both + np.diag((prior / length) ** 2 + _REGULAR)
    b = np.linalg.solve(gram, both.T @ (target * weight)) / length
    return b[: X.shape[1]], b[X.shape[1] :]


def _weights(prepared: Prepared, torque: Sequence[Array], level: float, left: Array) -> Array:
    """Of the kept samples: less where the position does not determine the torque, shape (n,).

    Where friction changes steeply with position an error of either is large. So the squares that
    the law leaves are averaged over samples alike in local stiffness, and grow with it.
    """
    each = zip(prepared.segments, torque, strict=True)
    stuck = np.concatenate(
        [s.lowpass(_sticking(s, x, level, prepared.span))[s.kept] for s, x in each]
    )
    stuck = np.clip(stuck, 0.0, 1.0)
    classes = np.array_split(np.argsort(stuck, kind="stable"), min(_CLASSES, len(left)))
    means = [float(np.mean(left[c] ** 2)) for c in classes]
    rising = isotonic_regression(means, weights=[len(c) for c in classes]).x
    sliding = max(float(rising[len(rising) // 3]), _NONE**2)
    squares = np.empty(len(left))
    for c, x in zip(classes, rising, strict=True):
        squares[c] = x
    more = np.maximum(stuck * (LAW_ERROR * level) ** 2, squares - sliding)
    return np.asarray(1.0 / np.sqrt(1.0 + np.maximum(more, 0.0) / sliding))


def _sticking(s: Segment, torque: Array, level: float, span: float) -> Array:
    """How much of the friction is held by the position, 0 in sliding and 1 at rest, shape (n,)."""
    moved = np.maximum(np.abs(np.gradient(s.signals[:, Q])), s.noise.resolution)
    stiffness = np.abs(np.gradient(torque)) / moved
    stuck = np.clip(stiffness * span / (_STICKING * level), 0.0, 1.0)
    # slower than the encoder resolves, the direction of the next displacement is not known
    slowest = s.noise.resolution * 2.0 * np.pi * s.corner_hz
    stuck[np.abs(s.signals[:, V]) < slowest] = 1.0
    return np.asarray(stuck**2)
