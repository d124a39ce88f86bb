"""Standard errors of parameters with a non-smooth objective, from the objective itself."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.load_coefficients import with_load
from frictionjoint.identify.search import Search
from frictionjoint.identify.segment import Prepared


def with_leaps(
    prepared: Prepared, fitted: Fit, cov: Array, block_of_sample: NDArray[np.int64]
) -> Array:
    """The covariance, wider for parameters with discontinuous torque, shape (p, p).

    Args:
        cov: of all parameters, see `uncertainty.covariance`, shape (p, p).
        block_of_sample: blocks of time, shape (n,).
    """
    search = Search(prepared, fitted.terms, fitted.shape)
    wider = np.ones(len(cov))
    for k in search.leaping:
        at = k + fitted.layout.linear.stop
        error = float(np.sqrt(cov[at, at]))
        if np.isfinite(error):
            far = _farthest(search, fitted, k, error, block_of_sample)
            wider[at] = max(1.0, 0.5 * far / error) if error else 1.0
    return cov * np.outer(wider, wider)


def _farthest(search: Search, fitted: Fit, k: int, error: float, block: NDArray[np.int64]) -> float:
    """The largest change, in either direction, for which a parameter cannot be distinguished."""
    x = search.start
    others = np.arange(fitted.jacobian.shape[1]) != k + fitted.layout.linear.stop
    J = with_load(fitted.jacobian, fitted.layout)[:, others & ~fitted.bound]
    J = J * fitted.weight[:, None]
    Q = orthonormal(J / lengths(J))
    here = _left(search, Q, x, block)
    longest = 0.0
    for sign in (-1.0, 1.0):
        # from half a standard error up to half of the number
        way = max(0.5 * error, 1e-4 * abs(x[k]))
        while way < 0.5 * abs(x[k]):
            there = x.copy()
            there[k] = np.clip(x[k] + sign * way, *(b[k] for b in search.bounds))
            more = _left(search, Q, there, block) - here
            if more.sum() <= np.std(more) * np.sqrt(len(more)):
                longest = max(longest, way)
            way *= 2.0**0.5
    return longest


def _left(search: Search, Q: Array, x: Array, block: NDArray[np.int64]) -> Array:
    """Sum of squares of each block at a point, with the directions Q refitted, shape (B,)."""
    e = search.residual(x)
    _, own = np.unique(block, return_inverse=True)
    return np.bincount(own, (e - Q @ (Q.T @ e)) ** 2).astype(np.float64)
