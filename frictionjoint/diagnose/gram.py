"""All questions about candidates, answered from Gram matrices by block: samples are touched once.

The law's own sensitivities are projected out of every candidate and of the residual on all data
(Frisch and Waugh 1933): the law may know a fold, the effect may not. What a model predicts of a
fold then follows from coefficients fitted to the other folds.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks, whitened
from frictionjoint.diagnose.library import Candidate
from frictionjoint.identify.design import lengths
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import Timing

Columns = NDArray[np.int64]

FLIPS = 999
_HALVES = 50
# of a sample, from which on a delay may be an effect
_LATE = 0.9
# directions of a set of columns below this fraction of the largest count as dependent
_RCOND = 1e-8
# part of what determines a coefficient that may lie in one fold: beyond it that fold is halved
_CONCENTRATED = 0.9


@dataclass(frozen=True)
class Screen:
    """Gram matrices of a fit's terms, of candidates and of what they are to explain.

    Attributes:
        blocks: of the fit.
        whole: the law projected out, by block, shape (B, c, c), the target last.
        tested: law and terms projected out, the target is the residual, shape (B, c, c).
        white: the same of whitened columns, by smaller pieces, where what acts seldom shows.
        terms: columns of each term of the fit. candidates: columns of each candidate.
    """

    blocks: Blocks
    whole: Array
    tested: Array
    white: Array
    terms: tuple[Columns, ...]
    candidates: tuple[Columns, ...]

    def held_out(self, sets: Sequence[Columns]) -> tuple[Array, Array]:
        """Squares of each block under coefficients fitted without its fold.

        Returns:
            those, shape (B,), and the squares left on the folds fitted to, by block's fold,
            shape (B,).
        """
        at = np.concatenate([*sets, []]).astype(np.int64)
        y = self.whole.shape[1] - 1
        squares, trained = self.whole[:, y, y].copy(), np.empty(self.blocks.count)
        folds = self._folds(sets)
        total = self.whole.sum(axis=0)
        for fold in np.unique(folds):
            inside = folds == fold
            part = self.whole[inside]
            G = total - part.sum(axis=0)
            A, b = G[np.ix_(at, at)], G[at, y]
            beta = _least_squares(A, b)
            trained[inside] = G[y, y] - b @ beta
            cross = part[:, at, y] @ beta
            quadratic = np.einsum("i,bij,j->b", beta, part[:, at[:, None], at], beta)
            squares[inside] += quadratic - 2.0 * cross
        return squares, trained

    def _folds(self, sets: Sequence[Columns]) -> Columns:
        """The folds; halved where one of them holds all that determines a set."""
        fold = self.blocks.fold
        for at in sets:
            power = np.einsum("bii->b", self.whole[:, at[:, None], at])
            by_fold = np.bincount(fold, power)
            if by_fold.max() > _CONCENTRATED * by_fold.sum():
                return np.asarray(2 * fold + self.blocks.halves)
        return fold

    def surprises(self, signs: Array, whites: Array, at: Columns) -> Array:
        """How far out a candidate's score is under each row of signs, in nats, shape (rows,).

        The larger of that of the residual as it is, where what is slow shows, and whitened.
        """
        plain = self._surprise(self.tested, signs, at)
        return np.maximum(plain, self._surprise(self.white, whites, at))

    @staticmethod
    def _surprise(grams: Array, signs: Array, at: Columns) -> Array:
        score = grams[:, at, -1]
        spread = score.T @ score
        scale = np.sqrt(np.maximum(np.diag(spread), 1e-300))
        inverse = np.linalg.pinv(spread / np.outer(scale, scale), rcond=1e-9, hermitian=True)
        s = (signs @ score) / scale
        statistic = np.sum((s @ inverse) * s, axis=1)
        freedom = max(1, round(float(np.trace(inverse @ (spread / np.outer(scale, scale))))))
        return np.asarray(-np.log(np.maximum(chdtrc(freedom, statistic), 1e-300)))

    def halves(self, rng: np.random.Generator) -> tuple[Array, ...]:
        """Sums of the tested matrices over complementary halves of the blocks."""
        found = []
        for _ in range(_HALVES):
            chosen = rng.permutation(self.blocks.count) < self.blocks.count // 2
            first = self.tested[chosen].sum(axis=0)
            found += [first, self.tested.sum(axis=0) - first]
        return tuple(found)


def _least_squares(A: Array, b: Array) -> Array:
    if not len(b):
        return b
    scale = np.sqrt(np.maximum(np.diag(A), 1e-300))
    inverse = np.linalg.pinv(A / np.outer(scale, scale), rcond=_RCOND, hermitian=True)
    return np.asarray(inverse @ (b / scale) / scale)


def explained(G: Array, at: Columns) -> float:
    """Squares that a set of columns takes from the target of one Gram matrix."""
    return float(G[at, -1] @ _least_squares(G[np.ix_(at, at)], G[at, -1]))


def screen(fitted: Fit, blocks: Blocks, candidates: Sequence[Candidate] = ()) -> Screen:
    """Gram matrices for a fit and candidates."""
    w = fitted.weight[:, None]
    layout, free = fitted.layout, ~fitted.bound
    for i, term in enumerate(fitted.terms):
        # a delay at the end of its sample is no longer one of sampling
        if isinstance(term, Timing) and abs(term.delay) > _LATE * term.most:
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
    columns = [fitted.jacobian[:, base], *(fitted.jacobian[:, k] for k in own)]
    columns += [c.columns for c in candidates]
    U = np.column_stack([*columns, target, fitted.residual]) * w
    U /= lengths(U) * (np.arange(U.shape[1]) < U.shape[1] - 2) + (
        np.arange(U.shape[1]) >= U.shape[1] - 2
    )
    grams = blocks.gram(U)
    edges = np.cumsum([0, *(c.shape[1] for c in columns)])
    sets = [np.arange(a, b) for a, b in itertools.pairwise(edges)]
    n_own = len(own)
    whole = _projected(grams[:, :-1, :-1], sets[0])
    without_target = np.delete(np.arange(U.shape[1]), -2)
    known = np.concatenate(sets[: 1 + n_own])
    tested = _projected(grams[:, without_target[:, None], without_target], known)
    white = np.zeros((0, *tested.shape[1:]))
    if candidates:
        V = whitened(U[:, without_target], U[:, -1], fitted.log_index)
        white = _projected(blocks.gram(V, fine=True), known)
    shift = len(sets[0])
    moved = [s - shift for s in sets[1:]]
    # so that columns are counted alike in all
    own_columns = len(known) - shift
    room = ((0, 0), (own_columns, 0), (own_columns, 0))
    return Screen(
        blocks,
        whole,
        np.pad(tested, room),
        np.pad(white, room),
        tuple(moved[:n_own]),
        tuple(moved[n_own:]),
    )


def _projected(grams: Array, base: Columns) -> Array:
    """Gram matrices of all other columns with some projected out of them on all blocks."""
    p = len(base)
    total = grams.sum(axis=0)
    solved = np.linalg.pinv(total[:p, :p], rcond=1e-10, hermitian=True) @ total[:p, p:]
    T = np.vstack([-solved, np.eye(grams.shape[1] - p)])
    return np.asarray(T.T @ grams @ T)
