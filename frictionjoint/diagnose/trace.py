"""Which candidate explains a residual: a claim made on data it was not fitted to.

1. The base model's own sensitivities are projected out of every candidate (Frisch and Waugh), so
   that no candidate wins by undoing the fit.
2. Gain: share of the residual's sum of squares that goes away on folds the coefficients were not
   fitted to (whole logs where there are three or more).
3. False alarms: score contributions of the blocks, their signs flipped at random; the p-value is
   that of the maximum over all candidates, so the whole family is controlled.
4. Runner-up: paired bootstrap over blocks of the difference in held-out squares; where the
   interval holds zero the two are a tie, and of nested ones the simpler is taken.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks, whiten, whitener
from frictionjoint.diagnose.candidates import Candidate
from frictionjoint.identify.design import lengths
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.threads import side_by_side

FLIPS = 1999
_RESAMPLES = 300
_TIE_QUANTILE = 0.05
# columns whose independent part is below a thousandth of their size count as dependent
_RCOND = 1e-6


@dataclass(frozen=True)
class Ranked:
    """A candidate with its evidence.

    Attributes:
        held_out_gain: share of the residual variance taken away on held-out folds.
        p_value: of no effect, controlled over all candidates.
        coefficients: of the one-step fit, N m per column.
        admissible: the coefficients keep the effect's physical bounds.
        squares: held-out sum of squares by block.
        on_edge: a joint refit drove a shape number to the end of its physical range.
    """

    candidate: Candidate
    held_out_gain: float
    p_value: float
    coefficients: Array
    admissible: bool
    squares: Array = field(repr=False)
    on_edge: bool = False

    @property
    def name(self) -> str:
        """Name of the effect or variable."""
        return self.candidate.term.name


@dataclass(frozen=True)
class Ranking:
    """All candidates, best first, one an effect (its best shape).

    Attributes:
        ranked: best first. base_squares: held-out squares by block without any candidate.
    """

    ranked: tuple[Ranked, ...]
    base_squares: Array = field(repr=False)


def rank(
    candidates: list[Candidate],
    jacobian: Array,
    residual: Array,
    log_index: NDArray[np.int64],
    blocks: Blocks,
    rng: np.random.Generator,
) -> Ranking:
    """Rank candidates against a residual.

    Args:
        jacobian: sensitivities of the model so far, shape (n, p); residual: shape (n,).
    """
    J = scaled(jacobian)
    Z = [scaled(c.columns) for c in candidates]
    U = np.column_stack([J, *Z, residual])
    grams = blocks.gram(U)
    white = blocks.gram(whiten(U, log_index, whitener(residual, log_index)))
    p = J.shape[1]
    starts = np.cumsum([p, *(z.shape[1] for z in Z)])
    sets = [np.arange(a, b) for a, b in itertools.pairwise(starts)]
    base = np.arange(p)
    folds = {False: blocks.fold, True: blocks.within}
    none = grams[:, -1, -1]
    base_squares = {w: _least(_held_out(grams, base, f), none) for w, f in folds.items()}
    whole = grams.sum(axis=0)
    p_values = _flip_test((grams, white), base, sets, rng)
    rows = []
    for i, (candidate, own) in enumerate(zip(candidates, sets, strict=True)):
        within = candidate.within_logs
        squares = _least(
            _held_out(grams, np.concatenate([base, own]), folds[within]),
            _held_out(grams, own, folds[within]),
        )
        total = float(base_squares[within].sum())
        beta = solve_gram(whole, np.concatenate([base, own]))[p:] / lengths(candidate.columns)
        p_value = max(p_values[i], min(1.0, 2.0 * candidate.search_p))
        gain = 1.0 - float(squares.sum()) / total if total > 0.0 else 0.0
        rows.append(Ranked(candidate, gain, p_value, beta, _admissible(candidate, beta), squares))
    return Ranking(_best_of_each(rows), base_squares[False])


def held_out_squares(
    jacobian: Array, residual: Array, blocks: Blocks, within_logs: bool = False
) -> Array:
    """Sum of squares of each block with a fit's parameters as they would be without its fold.

    Args:
        jacobian: of a fit at its optimum, shape (n, p); residual: of the same fit, shape (n,).
        within_logs: folds cut every log.
    Returns:
        shape (B,); to first order in the change of the parameters.
    """
    grams = blocks.gram(np.column_stack([scaled(jacobian), residual]))
    folds = blocks.within if within_logs else blocks.fold
    moved = _held_out(grams, np.arange(jacobian.shape[1]), folds)
    return _least(moved, grams[:, -1, -1])


def scaled(X: Array) -> Array:
    """Columns of length one; those that are zero stay so."""
    return np.asarray(X / lengths(X))


def solve_gram(G: Array, columns: NDArray[np.int64]) -> Array:
    """Least squares of the last column on some others, from their Gram matrix.

    Columns the data cannot tell apart share their coefficient (minimum norm).
    """
    A = G[np.ix_(columns, columns)]
    return np.asarray(np.linalg.pinv(A, rcond=_RCOND, hermitian=True) @ G[columns, -1])


def _least(a: Array, b: Array) -> Array:
    """The better of two predictions.

    Refitting the model's own parameters without a fold can do more harm on that fold than good,
    where the other folds hardly determine them.
    """
    return a if a.sum() < b.sum() else b


def _held_out(grams: Array, columns: NDArray[np.int64], folds: NDArray[np.int64]) -> Array:
    """Sum of squares of each block under coefficients fitted without its fold."""
    with_target = np.append(columns, grams.shape[1] - 1)
    own = grams[:, with_target[:, None], with_target]
    total, inputs = own.sum(axis=0), np.arange(len(columns))
    squares = np.empty(len(grams))
    for fold in np.unique(folds):
        inside = folds == fold
        G = own[inside]
        beta = solve_gram(total - G.sum(axis=0), inputs)
        cross = G[:, :-1, -1] @ beta
        quadratic = np.einsum("i,bij,j->b", beta, G[:, :-1, :-1], beta)
        squares[inside] = G[:, -1, -1] - 2.0 * cross + quadratic
    return squares


def _flip_test(
    kinds: tuple[Array, ...],
    base: NDArray[np.int64],
    sets: list[NDArray[np.int64]],
    rng: np.random.Generator,
) -> Array:
    """p-value of each candidate, the largest score over all candidates as its null distribution.

    Statistics of many coefficients and of single constants are put on one scale by the chi-square
    tail each would have (Westfall and Young 1993, with an approximate marginal: it weighs the
    candidates against each other, the flips alone make the p-value). Each candidate is tested on
    the residual as it is, where slow effects show, and whitened, where fast ones do (`kinds`);
    both tests are members of the family.
    """
    blocks = len(kinds[0])
    signs = np.vstack([np.ones(blocks), rng.choice([-1.0, 1.0], size=(FLIPS, blocks))])
    largest = np.full((len(sets), FLIPS + 1), -np.inf)
    with side_by_side() as each:
        for grams in kinds:
            scores = _scores(grams, base, sets)
            for i, surprise in enumerate(each(partial(_surprise, signs), scores)):
                largest[i] = np.maximum(largest[i], surprise)
    null = largest[:, 1:].max(axis=0)
    return np.array([(1 + int(np.sum(null >= x))) / (FLIPS + 1) for x in largest[:, 0]])


def _surprise(signs: Array, score: Array) -> Array:
    """Of each row of signs how far out a candidate's score is, shape (flips + 1,)."""
    spread = score.T @ score
    inverse = np.linalg.pinv(spread, rcond=1e-9, hermitian=True)
    s = signs @ score
    statistic = np.sum((s @ inverse) * s, axis=1)
    freedom = max(1, int(np.linalg.matrix_rank(spread, hermitian=True)))
    return np.asarray(-np.log(chdtrc(freedom, statistic)))


def _scores(
    grams: Array, base: NDArray[np.int64], sets: list[NDArray[np.int64]]
) -> Iterator[Array]:
    """Contribution of each block to the score of each candidate, the base projected out."""
    total = grams.sum(axis=0)
    inverse = np.linalg.pinv(total[np.ix_(base, base)], rcond=1e-9, hermitian=True)
    fitted = inverse @ total[base, -1]
    inside = grams[:, base][:, :, base]
    for own in sets:
        P = inverse @ total[np.ix_(base, own)]
        score = grams[:, own, -1] - grams[:, base, -1] @ P
        score -= np.einsum("bij,j->bi", grams[:, own][:, :, base], fitted)
        score += np.einsum("ki,bkl,l->bi", P, inside, fitted)
        yield score


def _admissible(candidate: Candidate, beta: Array) -> bool:
    term = candidate.term
    if not isinstance(term, EffectTerm) or not term.effect.bounds:
        return True
    low, high = np.array(term.effect.bounds).T
    return bool(np.all(beta >= low) and np.all(beta <= high))


def _best_of_each(rows: list[Ranked]) -> tuple[Ranked, ...]:
    """The best shape of each effect and kind of curve, with the least p-value of all its shapes.

    The p-values are controlled over all shapes of all effects, so one of them is enough to say
    that the effect's cause is there; which shape it has is then a matter of the fit.
    """
    best: dict[tuple[str, str], Ranked] = {}
    least: dict[tuple[str, str], float] = {}
    for row in rows:
        key = (row.name, row.candidate.kind)
        if not row.admissible:
            continue
        least[key] = min(least.get(key, 1.0), row.p_value)
        if key not in best or row.held_out_gain > best[key].held_out_gain:
            best[key] = row
    found = (replace(row, p_value=least[key]) for key, row in best.items())
    return tuple(sorted(found, key=lambda r: -r.held_out_gain))


def margin(
    winner: Ranked, other: Ranked, base: Array, rng: np.random.Generator
) -> tuple[float, bool]:
    """Difference in held-out gain, and whether it is a tie."""
    draws = rng.integers(0, len(base), size=(_RESAMPLES, len(base)))
    difference = other.squares - winner.squares
    sample = difference[draws].sum(axis=1)
    mean = float(difference.sum() / base.sum())
    return mean, bool(np.quantile(sample, _TIE_QUANTILE) <= 0.0)


def selection_frequency(
    winner: Ranked, ranked: tuple[Ranked, ...], rng: np.random.Generator
) -> float:
    """How often the winner stays the best when blocks are drawn anew."""
    squares = np.stack([r.squares for r in ranked])
    n = squares.shape[1]
    draws = rng.integers(0, n, size=(_RESAMPLES, n))
    best = np.argmin(squares[:, draws].sum(axis=2), axis=0)
    return float(np.mean([ranked[i] is winner for i in best]))
