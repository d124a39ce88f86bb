"""How well a further recording would distinguish two effects, or determine parameters.

Each of two rival models is taken as true in turn. Its predictions on the logs and on the further
recording are fitted by the other model, with the law and all other effects refitted (to first
order). The residual of that fit is the distance of the two models: Hunter and Reiner (1965),
Atkinson and Fedorov (1975, T-optimality). The noise is the residual of the logs with its
autocorrelation, up to the length of a block of `blocks.make_blocks`; an error of the law that is
equal in every recording is not counted as noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.diagnose.candidate import columns_of, signals_of
from frictionjoint.identify.basis import pseudo_inverse
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import Term


class Noise:
    """Autocovariance of a fit's residual with Bartlett's weights (Newey and West 1987).

    Args:
        residual: of a fit, shape (n,); log_index: log of each sample.
        blocks: number of independent parts of the residual.
        every: decimation of a recording relative to the logs; each sample is the mean of so many
            samples.
    """

    def __init__(
        self, residual: Array, log_index: NDArray[np.int64], blocks: int, every: int = 1
    ) -> None:
        self.every = every
        lag = max(1, len(residual) // blocks // every)
        self.autocovariance = np.zeros(lag)
        count = 0
        for i in np.unique(log_index):
            e = residual[log_index == i]
            e = e[: len(e) // every * every].reshape(-1, every).mean(axis=1)
            count += len(e)
            power = np.abs(np.fft.rfft(e, 2 * len(e))) ** 2
            own = np.fft.irfft(power)[: min(lag, len(e))]
            self.autocovariance[: len(own)] += own
        self.autocovariance *= (1.0 - np.arange(lag) / lag) / count

    def coloured(self, U: Array) -> Array:
        """W with W'W = U' Sigma U, for columns U of one recording, shape (n, k)."""
        n, lag = len(U), len(self.autocovariance)
        size = 2 ** int(np.ceil(np.log2(n + lag)))
        wrapped = np.zeros(size)
        wrapped[:lag] = self.autocovariance
        wrapped[size - lag + 1 :] = self.autocovariance[:0:-1]
        # non-negative by Bartlett's weights, but for rounding
        spectrum = np.maximum(np.fft.rfft(wrapped).real, 0.0)
        return np.asarray(np.fft.irfft(np.fft.rfft(U, size, axis=0).T * np.sqrt(spectrum)).T)


@dataclass(frozen=True)
class Moments:
    """Sums over recordings: U'U, and the covariance of U'e under the noise; shape (k, k) each."""

    gram: Array
    noise: Array

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(self.gram + other.gram, self.noise + other.noise)


def moments(U: Array, noise: Noise) -> Moments:
    """Moments of the columns of one recording, shape (n, k), which has the sampling of `noise`."""
    W = noise.every * noise.coloured(U)
    return Moments(noise.every * (U.T @ U), W.T @ W)


@dataclass(frozen=True)
class Effect:
    """One of two rival effects."""

    term: Term  # with its fitted shape
    coefficients: Array  # N m per unit of its columns, see `columns_of`

    @property
    def size(self) -> int:
        """Number of its columns, including its torque."""
        return len(self.coefficients) + len(self._slopes) + 1

    @property
    def _slopes(self) -> tuple[float, ...]:
        """Shape numbers of the effect, except a delay, whose column is already a derivative."""
        return self.term.free_shape if self.term.coefficients else ()

    def columns(self, prepared: Prepared, fitted: Fit) -> Array:
        """Columns of the effect, their derivatives by its free shape numbers, and its torque."""
        signals = signals_of(prepared, fitted)
        X = columns_of(prepared, signals, self.term)
        torque = X @ self.coefficients
        slopes = []
        shape = self._slopes
        for k, x in enumerate(shape):
            h = 1e-3 * abs(x) or 1e-9
            moved = self.term.with_shape(tuple(y + h * (j == k) for j, y in enumerate(shape)))
            other = columns_of(prepared, signals, moved) @ self.coefficients
            slopes.append((other - torque) / h)
        return np.column_stack([X, *slopes, torque])


@dataclass(frozen=True)
class Separation:
    """How well two effects are distinguished."""

    deviations: float  # of the two models' squared errors, over its standard deviation
    share: float  # of what the true effect explains, that the other one cannot explain


def separation(sums: Moments, base: int, first: int, second: int) -> tuple[Separation, Separation]:
    """Separation if the first effect is true, and if the second is.

    Args:
        sums: over all recordings, of the columns [base | first effect | second effect], each effect
            as in `Effect.columns`; base, first, second: their numbers of columns.
    """
    law = np.arange(base, dtype=np.int64)
    pairs = ((base, first, base + first, second), (base + first, second, base, first))
    found = []
    for at, size, rival, others in pairs:
        truth = at + size - 1
        left, error = _left(sums, truth, np.concatenate([law, rival + np.arange(others - 1)]))
        whole, _ = _left(sums, truth, law)
        deviations = 0.5 * left / np.sqrt(error) if error > 0.0 else 0.0
        found.append(Separation(deviations, left / whole if whole > 0.0 else 0.0))
    return found[0], found[1]


def _left(sums: Moments, target: int, on: NDArray[np.int64]) -> tuple[float, float]:
    """Square of a column's distance d from the span of others, and d' Sigma d."""
    scale = np.sqrt(np.diag(sums.gram))
    scale[scale == 0.0] = 1.0
    G, S = (x / np.outer(scale, scale) for x in (sums.gram, sums.noise))
    w = np.zeros(len(G))
    w[target] = 1.0
    w[on] = -pseudo_inverse(G[np.ix_(on, on)]) @ G[on, target]
    square = scale[target] ** 2
    return max(0.0, float(w @ G @ w)) * square, max(0.0, float(w @ S @ w)) * square


def with_further(covariance: Array, jacobian: Array, further: Moments) -> Array:
    """Covariance of a fit's parameters with a further recording added to the logs, shape (p, p).

    Args:
        covariance: of the parameters from the logs; infinite entries stay unknown unless the
            recording determines them. jacobian: of the fit on the logs, shape (n, p).
        further: moments of the sensitivities along the recording.
    """
    old = jacobian.T @ jacobian
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    total = old + further.gram
    scale = np.sqrt(np.diag(total))
    dead = scale <= 0.0
    scale[dead] = 1.0
    both = np.outer(scale, scale)
    bread = pseudo_inverse(total / both) / both
    found = np.asarray(bread @ (old @ known @ old + further.noise) @ bread)
    found[dead, dead] = np.inf
    return found
