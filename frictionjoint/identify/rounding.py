"""Choices that do not depend on rounding.

Some models are equivalent: a bias and a spring over a short travel, or a gain and an inertia with
an unknown mass. Their residuals differ in the last bits only, which depend on the processor. Among
such models the first in the given order is chosen, on every machine.
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
    """The items by their nonnegative costs; items of equal cost keep their order."""
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
    """The item with the smallest cost; the first among equals."""
    return in_order(items, cost)[0]


def first_least(costs: Array) -> Index:
    """First row with the smallest cost in each column, shape (m,), of costs >= 0, shape (k, m)."""
    return np.asarray(np.argmax(costs <= costs.min(axis=0) * (1.0 + EQUAL), axis=0))


def rounded(x: Array) -> Array:
    """Numbers with six significant digits, which a fit has on every machine."""
    known = np.isfinite(x) & (x != 0.0)
    places = 5.0 - np.floor(np.log10(np.abs(x, where=known, out=np.ones_like(x))))
    return np.where(known, np.rint(x * 10.0**places) / 10.0**places, x)
