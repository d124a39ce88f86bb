"""Sums of squares and products by block of time.

Samples of a log are correlated, blocks several correlation times long are nearly not. Every
statistic of the trace (held-out gain, sign flips, bootstrap) is a function of the Gram matrices
of the blocks, so the samples are touched once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from frictionjoint.arrays import Array

Index = NDArray[np.int64]

_FEWEST_BLOCKS = 48
_MOST_BLOCKS = 240
_CORRELATION_TIMES = 5.0
_FOLDS = 5
_AR_ORDER = 6


@dataclass(frozen=True)
class Blocks:
    """Which block and which fold each sample belongs to.

    Attributes:
        of_sample: block of each sample, shape (n,).
        fold: fold of each block, shape (B,).
        within: folds that cut every log, for coefficients that belong to a log, shape (B,).
    """

    of_sample: Index
    fold: Index
    within: Index

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


def whitener(residual: Array, log_index: Index) -> Array:
    """Prediction-error filter of a residual: coefficients (1, -a1, ... -ap), by Yule and Walker."""
    lags = np.zeros(_AR_ORDER + 1)
    for i in np.unique(log_index):
        e = residual[log_index == i]
        lags += [float(e[k:] @ e[: len(e) - k]) for k in range(_AR_ORDER + 1)]
    if lags[0] <= 0.0:
        return np.ones(1)
    lags[0] *= 1.0 + 1e-6  # keeps the filter tame where the spectrum has deep holes
    return np.concatenate([[1.0], -solve_toeplitz(lags[:-1], lags[1:])])


def whiten(U: Array, log_index: Index, coefficients: Array) -> Array:
    """Filter the columns of U, each log on its own."""
    out = np.empty_like(U)
    for i in np.unique(log_index):
        out[log_index == i] = lfilter(coefficients, [1.0], U[log_index == i], axis=0)
    return out


def make_blocks(residual: Array, log_index: Index) -> Blocks:
    """Cut the logs into blocks, and the blocks into folds.

    Blocks span several correlation times of the residual, as far as enough blocks remain: what
    makes a residual correlated for longer is the effect that is looked for.

    With three logs or more a fold is a set of whole logs; with fewer, every log is cut into
    contiguous stretches.
    """
    logs = np.unique(log_index)
    longest = max(correlation_time(residual[log_index == i]) for i in logs)
    n = len(residual)
    length = int(np.clip(_CORRELATION_TIMES * longest, n / _MOST_BLOCKS, n / _FEWEST_BLOCKS))
    of_sample = np.empty(n, dtype=np.int64)
    fold: list[int] = []
    within: list[int] = []
    for i in logs:
        where = np.flatnonzero(log_index == i)
        k = max(1, round(len(where) / max(length, 1)))
        own = np.minimum(np.arange(len(where)) * k // len(where), k - 1)
        of_sample[where] = own + len(fold)
        cut = [int(b * _FOLDS // k) for b in range(k)]
        within += cut
        fold += [int(i) % _FOLDS] * k if len(logs) >= 3 else cut
    return Blocks(of_sample, np.array(fold), np.array(within))
