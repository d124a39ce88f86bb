"""Choices that rounding does not make.

Some models are one model with other names: a bias and a spring in a small travel, or a gain and an
inertia beside a mass that is not known. What they leave differs in the last bits only, and those
differ from processor to processor. Of such models the first in the given order is chosen, which is
the same everywhere.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from frictionjoint.arrays import Array, Index

# fraction by which two errors may differ and still count as equal: far above rounding and what a
# search makes of it, far below what decides anything
EQUAL = 1e-6

_T = TypeVar("_T")


def in_order(items: Sequence[_T], cost: Callable[[_T], float]) -> list[_T]:
    """The items by their costs, which are not negative; of equal costs as they were given."""
    costs = [cost(item) for item in items]
    ordered = sorted(range(len(items)), key=lambda k: costs[k])
    found: list[_T] = []
    while ordered:
        most = costs[ordered[0]] * (1.0 + EQUAL)
        equal = [k for k in ordered if costs[k] <= most]
        found += [items[k] for k in sorted(equal)]
        ordered = ordered[len(equal) :]
    return found


def best_of(items: Sequence[_T], cost: Callable[[_T], float]) -> _T:
    """The item of least cost; of equal costs the first."""
    return in_order(items, cost)[0]


def first_least(costs: Array) -> Index:
    """First row with the least cost in each column, shape (m,).

    Args:
        costs: not negative, shape (k, m).
    """
    return np.asarray(np.argmax(costs <= costs.min(axis=0) * (1.0 + EQUAL), axis=0))
