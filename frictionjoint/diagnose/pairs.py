"""Two effects behind one curve."""

import itertools

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.choice import numbers_of, worth_naming
from frictionjoint.diagnose.trace import Ranked, Ranking, scaled, solve_gram
from frictionjoint.identify.fit import ROUGH, Fit, fit
from frictionjoint.identify.prepare import Prepared

# pairs that are fitted, and what one may leave over what the curve leaves: a curve is tried with
# fewer numbers than all pairs have together
_FITTED, _LEAVES = 3, 0.5
# what two pairs may leave over each other to be as good
_ALIKE = 1.1


def first_of_two(
    prepared: Prepared, current: Fit, ranking: Ranking, curve: Ranked
) -> Ranked | None:
    """An effect that with a second one explains far more than a curve does, None without such two.

    A curve takes what all effects of its quantity explain together, an end stop beside a bias, say,
    where neither of these alone comes near it.

    Args:
        ranking: beside the current fit. curve: that would stand in for a cause.
    """
    found: list[tuple[float, int, Ranked]] = []
    for pair in _leading(ranking, current):
        terms = (*current.terms, *(r.candidate.term for r in pair))
        both = fit(prepared, terms, start=current.shape, closeness=ROUGH)
        left = (both.drive_rms / current.drive_rms) ** 2
        if left < _LEAVES * (1.0 - curve.held_out_gain):
            numbers = sum(numbers_of(r.candidate.term) for r in pair)
            found.append((left, numbers, pair[0]))
    if not found:
        return None
    least = min(left for left, _, _ in found)
    alike = [(numbers, left, first) for left, numbers, first in found if left <= _ALIKE * least]
    return min(alike, key=lambda x: x[:2])[2]


def _leading(ranking: Ranking, current: Fit) -> list[tuple[Ranked, Ranked]]:
    """Pairs of effects that explain most together, the first of each worth naming by itself."""
    named = [r for r in ranking.ranked if not r.candidate.smooth]
    worth = [worth_naming(r, current) for r in named]
    if not any(worth):
        return []
    Q_, _ = np.linalg.qr(scaled(current.free_jacobian))
    columns = [r.candidate.columns for r in named]
    X = scaled(np.column_stack([*columns, current.residual]))
    X = X - Q_ @ (Q_.T @ X)
    gram = X.T @ X
    ends = np.cumsum([0, *(c.shape[1] for c in columns)])
    own = [list(range(a, b)) for a, b in itertools.pairwise(ends)]
    pairs = [
        (i, j) for i, j in itertools.combinations(range(len(named)), 2) if worth[i] or worth[j]
    ]
    pairs.sort(key=lambda pair: -_explained(gram, own[pair[0]] + own[pair[1]]))
    # best first, and the first one is to be worth it
    ordered = [(i, j) if worth[i] else (j, i) for i, j in pairs[:_FITTED]]
    return [(named[i], named[j]) for i, j in ordered]


def _explained(gram: Array, columns: list[int]) -> float:
    """Share of the last column's squares that some others explain."""
    return float(gram[columns, -1] @ solve_gram(gram, np.array(columns)) / gram[-1, -1])
