"""P-values of candidates over the whole family of candidates.

A score is made of the products of a candidate's columns with the residual, summed over blocks of
time. Its distribution under chance follows from the part of the residual that the candidate, fitted
to other motion, does not predict, with random signs for the blocks. So the signal of a true effect
does not count as noise, and an effect that explains only the motion it was fitted to gains nothing.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc, fdtrc

from frictionjoint.arrays import Array
from frictionjoint.diagnose.gram import Columns, Screen
from frictionjoint.identify.basis import pseudo_inverse
from frictionjoint.threads import side_by_side

FLIPS = 999


def p_values(
    found: Screen, among: Sequence[float], rng: np.random.Generator
) -> tuple[Array, float]:
    """P-value of each candidate, from the largest score of the family under random signs, and the
    score that one in twenty of those maxima exceeds.

    A score is the reduction of the squared error by coefficients within their bounds; an impossible
    sign scores nothing. Scores of one and of several coefficients are put on one scale by the tail
    of their approximate marginal distributions (Westfall and Young 1993); the signs make the
    p-value. Each score is the larger of two: of the residual as it is, which shows slow
    effects, and of the whitened residual, which shows rare ones.

    Args:
        among: number of lines of a spectrum of which a candidate is the largest; random signs do
            not search the spectrum again.
    """
    if not found.candidates:
        return np.zeros(0), 0.0
    signs = rng.choice([-1.0, 1.0], size=(FLIPS, found.blocks.count))

    def of(at: Columns, lines: float) -> Array:
        both = []
        for columns in (found.tested, found.white):
            grams = found.grams(columns, at)
            A, b = grams[:, :-1, :-1], grams[:, :-1, -1]
            known = A, b, found.elsewhere(A, b), A.sum(axis=0), found.ranges(at)
            both.append(surprise(*known, signs, found.blocks.log))
        return np.asarray(np.maximum(*both) - np.log(lines))

    with side_by_side() as each:
        surprises = np.array(list(each(of, found.candidates, among)))
    return over_family(surprises), float(np.quantile(surprises[:, 1:].max(axis=0), 0.95))


def over_family(surprises: Array) -> Array:
    """P-values of candidates, shape (c,): their scores against the largest score by chance.

    Args:
        surprises: score of each candidate, and its scores by chance, shape (c, 1 + flips).
    """
    null = surprises[:, 1:].max(axis=0)
    return np.array([(1 + np.sum(null >= x)) / (1 + len(null)) for x in surprises[:, 0]])


def surprise(
    A: Array,
    b: Array,
    elsewhere: Array,
    total: Array,
    ranges: tuple[Array, Array],
    signs: Array,
    log: Columns,
) -> Array:
    """Negative log tail probability of a candidate's score, observed and under sign flips.

    Args:
        A: Gram matrices of its columns, shape (B, k, k). b: their products with the residual, (B,
            k).
        elsewhere: coefficients for each block, fitted to the other folds, (B, k).
        total: A summed over all blocks, with the precision of a prior, (k, k).
        ranges: least and largest coefficients, (k,) each.
        signs: of each block, shape (flips, B). log: of each block, (B,).
    Returns:
        shape (1 + flips,).
    """
    own = b - (A @ elsewhere[..., None])[..., 0]
    scores = np.vstack([b.sum(axis=0), signs @ own])
    inverse = pseudo_inverse(total, 1e-9)
    coefficients = np.clip(scores @ inverse, *ranges)
    explained = np.sum((2.0 * scores - coefficients @ total) * coefficients, axis=1)
    # as the chi-squared variable of the mean and variance that the blocks' spread gives it
    # (Satterthwaite 1946): how a few blocks spread several scores together is too rough for more
    by_chance = inverse @ own.T @ own
    mean, half_variance = float(np.trace(by_chance)), float(np.sum(by_chance * by_chance.T))
    if min(mean, half_variance) <= 0.0:
        return np.zeros(len(scores))
    k = mean**2 / half_variance
    statistic = np.maximum(explained, 0.0) * k / mean
    # signs make blocks independent; neighbours in a log are not quite (Newey and West 1987)
    together = own[:-1] * (log[:-1] == log[1:])[:, None]
    covariance = 2.0 * float(np.trace(inverse @ together.T @ own[1:]))
    statistic[0] *= mean / (mean + max(covariance, 0.0))
    # a few blocks know their spread roughly, and what signs make of it does not show that: the
    # effective number of blocks that determine the coefficients
    part = np.einsum("bij,ji->b", A, inverse)
    known = max(1.0, float(part.sum() ** 2 / max(np.sum(part**2), 1e-300)) - 1.0)
    tail = float(fdtrc(k, known, statistic[0] / k))
    return np.append(-np.log(max(tail, 1e-300)), _nats_of_chi_squared(k, statistic[1:]))


def _nats_of_chi_squared(k: float, statistic: Array) -> Array:
    """Negative log tail probability of many statistics, interpolated on a grid.

    Computing one tail exactly takes as long as everything else.
    """
    # in the square root of a statistic it is smooth down to zero
    root = np.sqrt(statistic)
    grid = np.linspace(0.0, float(root.max()), 100)
    nats = -np.log(np.maximum(chdtrc(k, grid**2), 1e-300))
    return np.asarray(np.interp(root, grid, nats))
