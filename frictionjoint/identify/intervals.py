"""Intervals from samples that are not independent: of parameters, and of an rms."""

from functools import lru_cache

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import Search
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.uncertainty import covariance


@lru_cache(maxsize=8)
def stated_covariance(prepared: Prepared, fitted: Fit) -> Array:
    """Covariance of a fit's parameters for the report, by its own blocks, shape (p, p).

    See `covariance`. It is wider for parameters with discontinuous torque: their standard errors
    come from the objective itself, which is not smooth.
    """
    block = make_blocks(prepared, fitted).of_sample
    cov = covariance(prepared, fitted, block)
    search = Search(prepared, fitted.terms, fitted.shape)
    wider = np.ones(len(cov))
    for k in search.leaping:
        at = k + fitted.layout.linear.stop
        error = float(np.sqrt(cov[at, at]))
        if np.isfinite(error):
            far = _farthest(search, fitted, k, error, block)
            wider[at] = max(1.0, 0.5 * far / error) if error else 1.0
    return cov * np.outer(wider, wider)


def _farthest(search: Search, fitted: Fit, k: int, error: float, block: Index) -> float:
    """The largest change, in either direction, for which a parameter cannot be distinguished."""
    x = search.start
    others = np.arange(fitted.jacobian.shape[1]) != k + fitted.layout.linear.stop
    J = fitted.layout.with_load(fitted.jacobian)[:, others & ~fitted.bound]
    J = J * fitted.weight[:, None]
    Q = orthonormal(J / lengths(J))
    _, own = np.unique(block, return_inverse=True)

    def left(at: Array) -> Array:
        """Sum of squares of each block, with the directions Q refitted."""
        e = search.residual(at)
        return np.bincount(own, (e - Q @ (Q.T @ e)) ** 2).astype(np.float64)

    here = left(x)
    longest = 0.0
    for sign in (-1.0, 1.0):
        # from half a standard error up to half of the number
        way = max(0.5 * error, 1e-4 * abs(x[k]))
        while way < 0.5 * abs(x[k]):
            there = x.copy()
            there[k] = np.clip(x[k] + sign * way, *(b[k] for b in search.bounds))
            more = left(there) - here
            if more.sum() <= np.std(more) * np.sqrt(len(more)):
                longest = max(longest, way)
            way *= 2.0**0.5
    return longest


def rms_interval(e: Array, block: Index) -> tuple[float, float]:
    """95% interval of the rms of e, by bootstrap over blocks of time; both of shape (n,)."""
    rng = np.random.default_rng(0)
    _, block = np.unique(block, return_inverse=True)
    sums, counts = np.bincount(block, e**2), np.bincount(block)
    draws = rng.integers(0, len(sums), size=(400, len(sums)))
    sample = np.sqrt(sums[draws].sum(axis=1) / counts[draws].sum(axis=1))
    low, high = np.quantile(sample, (0.025, 0.975))
    return float(low), float(high)
