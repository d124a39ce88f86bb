"""Standard errors and intervals for residuals that are neither white nor pure noise.

Three estimates of the parameters' covariance are computed, and in every direction the widest is
used:

* the sandwich summed over blocks of time (White 1980, by cluster): samples of a block may be
  correlated in any way, blocks are independent;
* the jackknife that leaves out one log at a time: effects common to a log (a temperature, a motion
  that the law describes badly) are one draw each;
* the jackknife that leaves out one regime of speed and direction at a time: if the law has the
  wrong form, its error is the same whenever the joint moves in the same way, however often that is
  recorded, and resampling of time does not show it.

They cover noise with memory, and a law whose error differs between logs or speeds. They do not
cover errors common to all logs and speeds: a wrong torque scale, a wrong mass in the MJCF, a
missing effect; nor the choice of effects or of the law's form. The variation between logs is
estimated from few of them: a 95% interval uses Student's quantile with one degree of freedom less
than logs (4.3 standard errors with three), not two.
"""

from functools import lru_cache

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.signals import V
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import Search
from frictionjoint.identify.segment import Prepared

_RCOND = 1e-10


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


def covariance(prepared: Prepared, fitted: Fit, block_of_sample: Index) -> Array:
    """Covariance of the parameters in the order of the Jacobian, shape (p, p), from the fitted logs
    and the block of each sample, shape (n,). Undetermined directions have infinite variance."""
    J = fitted.layout.with_load(fitted.jacobian) * fitted.weight[:, None]
    e = fitted.residual * fitted.weight
    scale = np.linalg.norm(J, axis=0)
    dead = scale < 1e-12 * scale.max()
    scale[dead] = 1.0
    # columns of Y are orthonormal combinations of those of the jacobian: Y = J / scale @ R
    squares, U = eigh((J / scale).T @ (J / scale))
    known = squares > _RCOND * squares.max()
    R = U[:, known] / np.sqrt(squares[known])
    Y = (J / scale) @ R
    found = _sandwich(Y, e, block_of_sample)
    for group in (fitted.log_index, regimes(prepared)):
        if np.any(group != group[0]):
            found = _wider(found, _jackknife(Y, e, group))
    cov = R @ found @ R.T / np.outer(scale, scale)
    cov[dead, dead] = np.inf
    return np.asarray(cov)


def regimes(prepared: Prepared) -> Index:
    """Range of speed and direction that each kept sample belongs to, shape (n,)."""
    v = prepared.at_kept(V)
    # six equally filled ranges of speed, each in both directions
    edges = np.quantile(np.abs(v), np.arange(1, 6) / 6)
    return np.asarray(2 * np.digitize(np.abs(v), edges) + (v > 0.0), dtype=np.int64)


def _sandwich(Y: Array, e: Array, group: Index) -> Array:
    """Sum over groups of their scores' squares."""
    scores = np.array([y.T @ own for y, own in _parts(Y, e, group)])
    n = len(scores)
    return np.asarray(scores.T @ scores * (n / max(1, n - 1)))


def _jackknife(Y: Array, e: Array, group: Index) -> Array:
    """Spread of the parameters when each group in turn is left out, to first order: they move by
    (1 - Y_g'Y_g)^-1 Y_g'e_g (Miller 1974)."""
    moves = []
    for y, own in _parts(Y, e, group):
        share, U = eigh(y.T @ y)
        # without more than 90% of what is known of a direction the first order is no answer
        moves.append(U @ ((U.T @ (y.T @ own)) / (1.0 - np.minimum(share, 0.9))))
    n = len(moves)
    D = np.array(moves)
    return np.asarray(D.T @ D * ((n - 1) / n))


def _parts(Y: Array, e: Array, group: Index) -> list[tuple[Array, Array]]:
    order = np.argsort(group, kind="stable")
    edges = np.flatnonzero(np.diff(group[order])) + 1
    return list(zip(np.split(Y[order], edges), np.split(e[order], edges), strict=True))


def _wider(first: Array, second: Array) -> Array:
    """Smallest covariance that is at least two others along the axes that make both diagonal."""
    squares, U = eigh(first)
    floor = max(float(squares.max()), float(np.trace(second))) * _RCOND
    L = U * np.sqrt(np.maximum(squares, floor))
    inverse = np.linalg.inv(L)
    ratio, W = eigh(inverse @ second @ inverse.T)
    M = L @ W
    return np.asarray((M * np.maximum(ratio, 1.0)) @ M.T)
