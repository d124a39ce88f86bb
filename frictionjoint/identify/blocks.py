"""Blocks of time, and the kinds of motion they belong to.

Samples of a log are correlated; blocks several correlation times long are nearly independent. A
candidate is tested on motion unlike the motion it was fitted to: on other logs if there are three
or more, else on another kind of motion, which is a group of blocks alike in speed, acceleration,
position and direction.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np
from scipy.cluster.vq import kmeans2
from scipy.linalg import solve_toeplitz

from frictionjoint.arrays import Array, Index
from frictionjoint.compiled import compiled, pointer
from frictionjoint.effects.signals import A, Q, V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared

FEWEST_BLOCKS = 48
CORRELATION_TIMES = 5.0
# logs from which on a fold is a log, not a kind of motion
LOGS = 3


class Folds(NamedTuple):
    """Membership of blocks in folds."""

    place: Index  # fold of each block, 0 to F - 1, shape (B,)
    inside: Array  # 1 where a block is inside a fold, else 0, shape (F, B)

    def sums(self, x: Array) -> Array:
        """Sum numbers of shape (B, ...) over the blocks of each fold; shape (F, ...)."""
        flat = self.inside @ x.reshape(len(x), -1)
        return np.asarray(flat.reshape(len(self.inside), *x.shape[1:]))


@dataclass(frozen=True)
class Blocks:
    """Assignment of samples to blocks and of blocks to folds."""

    of_sample: Index  # block of each sample, shape (n,)
    fold: Index  # log or kind of motion of each block, shape (B,)
    halves: Index  # half of its log, 0 or 1, for effects that act in one fold only, shape (B,)
    log: Index  # log of each block, shape (B,)
    noise: float = 0.0  # variance of white noise as dense as the torque instrument's, (N m)^2
    # directions of possible errors of the law, N m, shape (n, m), see `OtherLaws.errors`
    law_errors: Array | None = field(default=None, repr=False)

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.fold)

    @cached_property
    def folds(self) -> Folds:
        """Folds made of whole blocks."""
        return folds_of(self.fold)

    @cached_property
    def half_folds(self) -> Folds:
        """Folds made of the halves of each log."""
        return folds_of(2 * self.fold + self.halves)

    @cached_property
    def _edges(self) -> Index:
        """First sample of each block that has samples."""
        changes = np.flatnonzero(np.diff(self.of_sample, prepend=-1))
        return np.append(changes, len(self.of_sample))

    def gram(self, U: Array, at: Index) -> Array:
        """Gram matrix of columns `at`, shape (m,), of U, shape (n, c) with each column contiguous
        in memory, in each block, shape (B, m, m); zeros for blocks without samples."""
        edges = self._edges
        own = np.empty((len(edges) - 1, len(at), len(at)))
        gram_matrices(np.ascontiguousarray(U.T), at, edges, own)
        out = np.zeros((self.count, len(at), len(at)))
        out[self.of_sample[edges[:-1]]] = own
        return out


def folds_of(fold: Index) -> Folds:
    """Folds from the fold number of each block, shape (B,)."""
    names, place = np.unique(fold, return_inverse=True)
    return Folds(place, (np.arange(len(names))[:, None] == place).astype(float))


@compiled
def gram_matrices(U: Array, at: Index, edges: Index, out: Array) -> None:
    """Fill `out` with the Gram matrices of rows `at` of U between successive edges."""
    for j in range(len(at)):
        for k in range(j + 1):
            one, other = pointer(U, at[j] * U.shape[1]), pointer(U, at[k] * U.shape[1])
            for b in range(len(out)):
                total = 0.0
                for i in range(edges[b], edges[b + 1]):
                    total += one[i] * other[i]
                out[b, j, k] = total
                out[b, k, j] = total


def halves(count: int, rng: np.random.Generator) -> Array:
    """Random complementary halves of the blocks as 1 or 0, shape (halves, count).

    Source: Shah and Samworth (2013).
    """
    first = [rng.permutation(count) < count // 2 for _ in range(50)]
    return np.array([half for chosen in first for half in (chosen, ~chosen)], dtype=float)


def correlation_time(residual: Array) -> float:
    """Samples over which a residual stays correlated: sum of the autocorrelation to its zero."""
    e = residual - residual.mean()
    n = len(e)
    spectrum = np.abs(np.fft.rfft(e, 2 * n)) ** 2
    rho = np.fft.irfft(spectrum)[: n // 2]
    if rho[0] <= 0.0:
        return 1.0
    rho = rho / rho[0]
    below = np.flatnonzero(rho < 0.05)
    end = below[0] if below.size else len(rho)
    return float(1.0 + 2.0 * rho[1:end].sum())


def whitened(U: Array, residual: Array, log_index: Index, noise: float) -> Array:
    """Columns filtered by the predictor of a residual's next sample (Yule and Walker).

    Frequencies that the torque filter removed stay removed: above them the noise of the position,
    which the columns contain too, exceeds that of the torque.

    Args:
        U: shape (n, k). residual: shape (n,). Both contain the logs in order.
        noise: variance of white noise with the spectral density of the torque instrument.
    """
    lags = np.zeros(6 + 1)
    parts = [residual[log_index == i] for i in np.unique(log_index)]
    for e in parts:
        lags += [float(e[k:] @ e[: len(e) - k]) for k in range(len(lags))]
    if lags[0] <= 0.0:
        return U
    # a little more keeps the filter tame where the spectrum has deep holes
    lags[0] += noise * len(residual) + 1e-6 * lags[0]
    predictor = np.concatenate([[1.0], -solve_toeplitz(lags[:-1], lags[1:])])
    rows = np.empty(U.shape[::-1])
    for own in np.split(np.arange(len(U)), np.flatnonzero(np.diff(log_index)) + 1):
        log = slice(own[0], own[-1] + 1)
        for row, x in zip(rows, U.T, strict=True):
            row[log] = np.convolve(predictor, x[log])[: len(own)]
    return rows.T


@lru_cache(maxsize=8)
def make_blocks(prepared: Prepared, fitted: Fit) -> Blocks:
    """Cut the logs into blocks, and sort the blocks into folds.

    Blocks span several correlation times of the residual, as long as enough blocks remain. A longer
    correlation comes from the missing effect itself.
    """
    e, log_index = fitted.residual * fitted.weight, fitted.log_index
    logs = np.unique(log_index)
    longest = max(correlation_time(e[log_index == i]) for i in logs)
    n = len(e)
    length = int(np.clip(CORRELATION_TIMES * longest, n / 240, n / FEWEST_BLOCKS))
    of_sample = np.empty(n, dtype=np.int64)
    log: list[int] = []
    halves: list[int] = []
    for i in logs:
        where = np.flatnonzero(log_index == i)
        k = max(2, round(len(where) / max(length, 1)))
        own = np.minimum(np.arange(len(where)) * k // len(where), k - 1)
        of_sample[where] = own + len(log)
        halves += [int(2 * b >= k) for b in range(k)]
        log += [int(i)] * k
    if len(logs) < LOGS:
        key = "kinds", tuple(np.bincount(log).tolist())
        fold = prepared.columns.get(key, partial(_kinds, prepared, of_sample))
    elif len(logs) < 8:
        fold = np.array(log)
    else:
        # similar logs do not test each other: with many logs they share a fold
        fold = _kinds(prepared, log_index)[np.array(log)]
    variance = [s.noise.torque / (2.0 * s.dt * s.step) for s in prepared.segments]
    noise = float(np.mean(variance)) * fitted.gain**2
    return Blocks(of_sample, fold, np.array(halves), np.array(log), noise)


def _kinds(prepared: Prepared, of_sample: Index) -> Index:
    """Kind of motion of each block, or log: speed, acceleration, mean position and direction."""
    q, v, a = (prepared.at_kept(k) for k in (Q, V, A))
    count = np.bincount(of_sample)

    def mean(x: Array) -> Array:
        return np.asarray(np.bincount(of_sample, x) / count)

    rows = np.column_stack([np.sqrt(mean(v**2)), np.sqrt(mean(a**2)), mean(q), mean(np.sign(v))])
    return kinds_of(rows)


def kinds_of(rows: Array) -> Index:
    """Kind of each row, 0 to 3 at most, shape (n,), by k-means with normalised columns and the best
    of a few starts; equal rows of shape (n, k) give equal kinds."""
    spread = rows.std(axis=0)
    scaled = (rows - rows.mean(axis=0)) / np.where(spread > 0.0, spread, 1.0)
    count = min(4, len(np.unique(scaled, axis=0)))
    tries = []
    for seed in range(4):
        centres, found = kmeans2(scaled, count, iter=100, minit="++", rng=seed)
        tries.append((float(np.sum((scaled - centres[found]) ** 2)), seed, found))
    return np.asarray(min(tries)[2], dtype=np.int64)
