"""How likely chance explains as much as a candidate: p-values over the whole family of candidates.

A score comes of the products of a candidate's columns with the residual, summed over blocks of
time. What it would be by chance follows from the part of the residual that the candidate, fitted to
other motion, does not predict: with random signs for the blocks. So an effect that stands alone
does not count as its own noise, and one that explains only the motion it was fitted to gains
nothing.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc, fdtrc

from frictionjoint.arrays import Array
from frictionjoint.diagnose.gram import Columns, Screen
from frictionjoint.identify.basis import pseudo_inverse
from frictionjoint.threads import side_by_side

FLIPS = 999
# points of a tail that are calculated, and the least that one counts as
_GRID, _LEAST_TAIL = 100, 1e-300


def p_values(
    found: Screen, among: Sequence[float], rng: np.random.Generator
) -> tuple[Array, float]:
    """Of each candidate, the largest surprise of the family under random signs as its null.

    With the surprise that one in twenty of those exceeds.

    A score is the squares that coefficients within their range explain: a sign that is impossible
    is no surprise. Scores of many coefficients and of single ones are put on one scale by the tail
    of the distribution each would have (Westfall and Young 1993, with an approximate marginal: it
    weighs the candidates against each other, the signs make the p-value). Each is the larger of
    that of the residual as it is, where what is slow shows, and whitened, where what acts seldom
    shows.

    Args:
        among: lines of a spectrum that a candidate is the largest of, which random signs do not
            search again.
    """
    if not found.candidates:
        return np.zeros(0), 0.0
    signs = rng.choice([-1.0, 1.0], size=(FLIPS, found.blocks.count))

    def of(at: Columns, lines: float) -> Array:
        both = []
        for white in (False, True):
            grams = found.products(at, white)
            A, b = grams[:, :-1, :-1], grams[:, :-1, -1]
            known = A, b, found.elsewhere(A, b), A.sum(axis=0), found.ranges(at)
            both.append(surprise(*known, signs, found.blocks.log))
        return np.asarray(np.maximum(*both) - np.log(lines))

    with side_by_side() as each:
        surprises = np.array(list(each(of, found.candidates, among)))
    return over_family(surprises), float(np.quantile(surprises[:, 1:].max(axis=0), 0.95))


def over_family(surprises: Array) -> Array:
    """P-values of candidates, shape (c,): of what they reach, what the best reaches by chance.

    Args:
        surprises: of each, and by chance, shape (c, 1 + flips).
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
    """How far out a candidate's score is, and by chance, in nats, shape (1 + flips,).

    Args:
        A: Gram matrices of its columns, shape (B, k, k). b: their products with the residual,
            (B, k). elsewhere: coefficients of each block, fitted to other folds, (B, k).
        total: A of all blocks, with the precision of a prior, (k, k).
        ranges: least and largest coefficients, (k,) each.
        signs: of each block, shape (flips, B). log: of each block, (B,).
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
    if half_variance <= 0.0:
        return np.zeros(len(scores))
    k = mean**2 / half_variance
    statistic = np.maximum(explained, 0.0) * k / mean
    # signs make blocks independent; neighbours in a log are not quite (Newey and West 1987)
    together = own[:-1] * (log[:-1] == log[1:])[:, None]
    covariance = 2.0 * float(np.trace(inverse @ together.T @ own[1:]))
    statistic[0] *= mean / (mean + max(covariance, 0.0))
    # a few blocks know their spread roughly, and what signs make of it does not show that
    known = max(1.0, _independent(A, inverse) - 1.0)
    tail = float(fdtrc(k, known, statistic[0] / k))
    return np.append(-np.log(max(tail, _LEAST_TAIL)), _nats_of_chi_squared(k, statistic[1:]))


def _nats_of_chi_squared(k: float, statistic: Array) -> Array:
    """Less the logarithm of the tail beyond each of many statistics, between points of a grid.

    The tail of one takes as long as all else that is done with it.
    """
    # in the square root of a statistic it is smooth down to zero
    root = np.sqrt(statistic)
    grid = np.linspace(0.0, float(root.max()), _GRID)
    nats = -np.log(np.maximum(chdtrc(k, grid**2), _LEAST_TAIL))
    return np.asarray(np.interp(root, grid, nats))


def _independent(grams: Array, inverse: Array) -> float:
    """Blocks that determine the coefficients, counted by how much each of them does."""
    part = np.einsum("bij,ji->b", grams, inverse)
    return float(part.sum() ** 2 / max(np.sum(part**2), 1e-300))
