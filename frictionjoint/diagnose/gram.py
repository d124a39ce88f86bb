"""Scores of candidates from Gram matrices of their columns and the residual, block by block.

The law's own sensitivities are projected out of every candidate and of the residual on all data
(Frisch and Waugh 1933): the law is fitted to a fold, the effect is not. So are the directions of
possible errors of the law: what another law would explain as well supports no effect. The
prediction for a fold follows from coefficients fitted to the other folds. Only the Gram matrices
that a question needs are computed: those of all pairs of candidates would not fit into memory.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import DEPENDENT, lengths, pseudo_inverse, take_out, without
from frictionjoint.identify.blocks import Blocks, Folds, whitened
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import Timing

Columns = NDArray[np.int64]


@dataclass(frozen=True)
class Screen:
    """Terms of a fit, candidates and the target, all weighted."""

    blocks: Blocks  # of the fit
    columns: Array  # the law projected out, shape (n, c), the target last
    tested: Array  # law and terms projected out, the residual last, shape (n, c)
    white: Array  # the same, whitened
    # range of the coefficient of each column but the last, shape (c - 1,); to first order, a shape
    # number changes by no more than one search may change it
    low: Array
    high: Array
    # columns of the initial friction state of each log, shape (c - 1,): like the law's they are
    # fitted on all data
    begun: NDArray[np.bool_]
    terms: tuple[Columns, ...]  # columns of each term of the fit
    candidates: tuple[Columns, ...]  # columns of each candidate

    def held_out(self, sets: Sequence[Columns]) -> tuple[Array, Array]:
        """Sum of squares of each block with coefficients fitted without its fold.

        Returns:
            these, shape (B,), and the sums of squares on the other folds, by the block's fold,
            shape (B,).
        """
        at = np.concatenate([*sets, []]).astype(np.int64)
        grams = self.grams(self.columns, at)
        A, b, squares = grams[:, :-1, :-1], grams[:, :-1, -1], grams[:, -1, -1].copy()
        folds = self._folds(A)
        rest = grams.sum(axis=0) - folds.sums(grams)
        beta = _least_squares(rest[:, :-1, :-1], rest[:, :-1, -1], *self.ranges(at))
        trained = rest[:, -1, -1] + _change(rest[:, :-1, :-1], rest[:, :-1, -1], beta)
        squares += _change(A, b, beta[folds.place])
        return squares, trained[folds.place]

    def _folds(self, grams: Array) -> Folds:
        """The folds; half-log folds if one fold alone determines a coefficient."""
        by_fold = self.blocks.folds.sums(np.einsum("bii->bi", grams))
        # 90% of a coefficient's columns in one fold
        if np.any(by_fold.max(axis=0) > 0.9 * by_fold.sum(axis=0)):
            return self.blocks.half_folds
        return self.blocks.folds

    def grams(self, columns: Array, at: Columns) -> Array:
        """Gram matrices of some columns and the last one, by block, shape (B, k + 1, k + 1).

        The initial friction state of the logs is projected out; it has no row in the matrices.
        """
        grams = self.blocks.gram(columns, np.append(at, columns.shape[1] - 1))
        begun = np.append(self.begun[at], False)
        if not begun.any():
            return grams
        total = grams.sum(axis=0)
        inverse = pseudo_inverse(total[np.ix_(begun, begun)])
        less = np.eye(len(begun))[:, ~begun]
        less[begun] = -inverse @ total[np.ix_(begun, ~begun)]
        return np.asarray(less.T @ grams @ less)

    def ranges(self, at: Columns) -> tuple[Array, Array]:
        """Least and largest coefficients of some columns of `grams`, shape (k,) each."""
        at = at[~self.begun[at]]
        return self.low[at], self.high[at]

    def elsewhere(self, A: Array, b: Array) -> Array:
        """Coefficients for each block, fitted to the other folds, shape (B, k).

        Args:
            A: Gram matrices, shape (B, k, k). b: products with the target, shape (B, k).
        """
        folds = self._folds(A)
        inverse = pseudo_inverse(A.sum(axis=0) - folds.sums(A))
        sums = b.sum(axis=0) - folds.sums(b)
        return np.asarray((inverse @ sums[..., None])[folds.place, :, 0])

    def worth(self, parts: Array, at: Columns) -> Array:
        """Squared residual that columns explain in each part of the blocks, shape (parts,).

        The expectation of as many coefficients by chance is subtracted.

        Args:
            parts: 1 or 0 for each block, shape (parts, B).
        """
        grams = self.grams(self.tested, at)
        k = grams.shape[1]
        G = (parts @ grams.reshape(len(grams), -1)).reshape(-1, k, k)
        scale = np.sqrt(np.maximum(np.einsum("pii->pi", G[:, :-1, :-1]), 1e-300))
        inside = G[:, :-1, :-1] / (scale[:, :, None] * scale[:, None, :])
        b = G[:, :-1, -1] / scale
        inverse = pseudo_inverse(inside)
        found = np.einsum("pi,pij,pj->p", b, inverse, b)
        return np.asarray(found - 2.0 * (k - 1) * G[:, -1, -1] / self.blocks.count)


def _change(A: Array, b: Array, beta: Array) -> Array:
    """Change of the sums of squares by coefficients, shape (f,).

    Args:
        A: Gram matrices, shape (f, k, k). b: products with the target, (f, k). beta: (f, k).
    """
    return np.asarray(np.sum(((A @ beta[..., None])[..., 0] - 2.0 * b) * beta, axis=1))


def _least_squares(A: Array, b: Array, low: Array, high: Array) -> Array:
    """Coefficients within their ranges, shape (f, k).

    Args:
        A: Gram matrices of the columns, shape (f, k, k). b: their products with the target, (f, k).
        low, high: shape (k,).
    """
    size = np.diagonal(A, axis1=1, axis2=2)
    # what the data without a fold do not show has no coefficient there
    scale = np.where(size > 1e-20 * size.max(axis=0), np.sqrt(np.maximum(size, 0.0)), 1e150)
    inside = A / (scale[:, :, None] * scale[:, None, :])
    inverse = pseudo_inverse(inside)
    beta = (inverse @ (b / scale)[..., None])[..., 0] / scale
    for f in np.flatnonzero(np.any((beta < low) | (beta > high), axis=1)):
        beta[f] = _bounded(inside[f], b[f] / scale[f], low * scale[f], high * scale[f]) / scale[f]
    return np.asarray(beta)


def _bounded(A: Array, b: Array, low: Array, high: Array) -> Array:
    """Coefficients within their ranges, for those whose free solution is not."""
    values, vectors = eigh(A)
    roots = np.sqrt(np.maximum(values, DEPENDENT * values.max()))
    rows, target = roots[:, None] * vectors.T, vectors.T @ b / roots
    return np.asarray(lsq_linear(rows, target, (low, high), method="bvls").x)


def screen(fitted: Fit, blocks: Blocks, candidates: Sequence[Candidate] = ()) -> Screen:
    """Inner products of the columns of a fit and of candidates."""
    w = fitted.weight[:, None]
    layout, free = fitted.layout, fitted.open.copy()
    for i, term in enumerate(fitted.terms):
        # of a term one on its bound acts too, and may leave it where a fold is missing
        free[layout.coefficients(i)] = True
        # the derivative of a discontinuous torque by a shape number predicts no change of it
        if term.effect.leaps:
            free[layout.numbers(i)] = False
    own = [
        np.array([k for k in layout.of_term(i) if free[k]], dtype=np.int64)
        for i, t in enumerate(fitted.terms)
        if not isinstance(t, Timing)
    ]
    taken = set(np.concatenate([*own, []]).astype(int))
    base = [k for k in range(fitted.jacobian.shape[1]) if free[k] and k not in taken]
    target = fitted.residual.copy()
    for i, term in enumerate(fitted.terms):
        if not isinstance(term, Timing):
            at = layout.coefficients(i)
            target += fitted.jacobian[:, at] @ fitted.beta[at]
    wrong = () if blocks.law_errors is None else (blocks.law_errors,)
    law = np.hstack([fitted.jacobian[:, base], fitted.begun, *wrong]) * w
    law = law / lengths(law)
    sets = [fitted.jacobian[:, k] for k in own]
    sets += [c.columns if c.begun is None else np.hstack([c.columns, c.begun]) for c in candidates]
    edges = np.cumsum([0, *(x.shape[1] for x in sets)])
    begun = [np.zeros(len(k), dtype=bool) for k in own]
    begun += [
        np.arange(x.shape[1]) >= c.columns.shape[1]
        for x, c in zip(sets[len(own) :], candidates, strict=True)
    ]
    # columns in memory one after the other, the target last
    rows = np.empty((edges[-1] + 1, len(target)))
    np.concatenate([rows[:0], *(x.T for x in sets)], out=rows[:-1])
    rows[:-1] *= fitted.weight
    size = lengths(rows[:-1].T)
    rows[:-1] /= size[:, None]
    low, high = _ranges(fitted, own, candidates) * size
    rows[-1] = target * fitted.weight
    columns = without(rows.T, law)
    tested = white = columns[:, :0]
    if candidates:
        known = np.vstack([law.T, rows[: edges[len(own)]]]).T
        rows[-1] = fitted.residual * fitted.weight
        noise = fitted.log_index, blocks.noise
        white = whitened(rows.T, rows[-1], *noise)
        take_out(white.T, whitened(known, rows[-1], *noise))
        take_out(rows, known)
        tested = rows.T
    places = [np.arange(a, b) for a, b in itertools.pairwise(edges)]
    return Screen(
        blocks=blocks,
        columns=columns,
        tested=tested,
        white=white,
        low=low,
        high=high,
        begun=np.concatenate([*begun, []]).astype(bool),
        terms=tuple(places[: len(own)]),
        candidates=tuple(places[len(own) :]),
    )


def _ranges(fitted: Fit, own: Sequence[Columns], candidates: Sequence[Candidate]) -> Array:
    """Least and largest coefficient of each column, shape (2, c)."""
    pairs = [(fitted.low[k], fitted.high[k]) for columns in own for k in columns]
    for c in candidates:
        pairs += c.bounds or ((-np.inf, np.inf),) * c.columns.shape[1]
        pairs += ((-np.inf, np.inf),) * (0 if c.begun is None else c.begun.shape[1])
    return np.array(pairs).reshape(-1, 2).T
