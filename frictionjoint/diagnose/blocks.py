"""Blocks of time, and the kinds of motion they are of.

Samples of a log are correlated, blocks several correlation times long are nearly not. A claim is
tested on motion unlike that it was fitted to: on other logs where there are three or more, else on
another kind of motion: blocks alike in speed, acceleration, position and direction.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.cluster import KMeans
from sklearn.preprocessing import StandardScaler

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import A, Q, V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import Prepared

Index = NDArray[np.int64]

_FEWEST_BLOCKS = 48
_MOST_BLOCKS = 240
_CORRELATION_TIMES = 5.0
# logs from which on a fold is a log, and kinds of motion where there are fewer
_LOGS, _KINDS = 3, 4


@dataclass(frozen=True)
class Blocks:
    """Which block each sample belongs to, and which fold each block.

    Attributes:
        of_sample: shape (n,). fold: logs or kinds of motion, shape (B,).
        halves: first and second half of each log, for what acts in one fold alone, shape (B,).
        log: shape (B,).
    """

    of_sample: Index
    fold: Index
    halves: Index
    log: Index

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.fold)

    def gram(self, U: Array) -> Array:
        """U'U of each block, shape (B, m, m)."""
        edges = np.flatnonzero(np.diff(self.of_sample, prepend=-1))
        parts = np.split(U, edges[1:])
        return np.stack([part.T @ part for part in parts])


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


def make_blocks(prepared: Prepared, fitted: Fit) -> Blocks:
    """Cut the logs into blocks, and sort the blocks into folds.

    Blocks span several correlation times of the residual, as far as enough blocks remain: what
    makes a residual correlated for longer is the effect that is looked for.
    """
    e, log_index = fitted.residual * fitted.weight, fitted.log_index
    logs = np.unique(log_index)
    longest = max(correlation_time(e[log_index == i]) for i in logs)
    n = len(e)
    length = int(np.clip(_CORRELATION_TIMES * longest, n / _MOST_BLOCKS, n / _FEWEST_BLOCKS))
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
    fold = np.array(log) if len(logs) >= _LOGS else _kinds(prepared, of_sample)
    return Blocks(of_sample, fold, np.array(halves), np.array(log))


def _kinds(prepared: Prepared, of_sample: Index) -> Index:
    """Kind of motion of each block: speed, acceleration, mean position and direction."""
    q, v, a = (
        np.concatenate([s.signals[:: s.step, k][s.kept] for s in prepared.segments])
        for k in (Q, V, A)
    )
    count = np.bincount(of_sample)

    def mean(x: Array) -> Array:
        return np.asarray(np.bincount(of_sample, x) / count)

    rows = np.column_stack(
        [np.sqrt(mean(v**2)), np.sqrt(mean(a**2)), mean(q), mean(np.sign(v))]
    )
    rows = StandardScaler().fit_transform(rows)
    found = KMeans(min(_KINDS, len(rows)), n_init=4, random_state=0).fit_predict(rows)
    return np.asarray(found, dtype=np.int64)
