"""The one score of a set of candidates: squares left of motion unlike that it was fitted to."""

from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array, Index
from linear_search.columns import Columns, Models

# of a Gram matrix of columns of length 1, what keeps it regular
_REGULAR = 1e-9
# of a drive, what is as good as nothing
_NO_DRIVE = 1e-6


class Solved(NamedTuple):
    """Coefficients of a set, shape (k,), and what it leaves, with the prior's rows, (n + m,)."""

    coefficients: Array
    left: Array


class Score:
    """Scores of sets in one experiment, all from block sums of products of their columns."""

    def __init__(self, columns: Columns) -> None:
        self.columns = columns
        self.experiment = columns.experiment
        self.blocks = columns.experiment.blocks
        n = len(self.experiment.target)
        self.nothing: Array = self.blocks.sums(self.experiment.residual[:n] ** 2)

    def stacked(self, models: Models) -> tuple[Array, Array, Array, Array]:
        """Columns of length 1 with the prior's rows, their range, and their length."""
        parts = self.columns.of(models)
        x = np.hstack([p.out for p in parts])
        length = np.linalg.norm(x, axis=0)
        length[length == 0.0] = 1.0
        low = np.concatenate([p.low for p in parts]) * length
        high = np.concatenate([p.high for p in parts]) * length
        return x / length, low, high, length

    def solve(self, models: Models) -> Solved:
        """Fit a set to all that there is."""
        x, low, high, length = self.stacked(models)
        r = self.experiment.residual
        z = _solved(x.T @ x, x.T @ r, low, high)
        return Solved(z / length, r - x @ z)

    def squares(self, models: Models) -> float:
        """Squares of all, with the prior's rows, as `held_out` states them."""
        left = self.solve(models).left
        return float(left @ left) * self._over_drive(models)

    def _over_drive(self, models: Models) -> float:
        """Squares count in proportion to the drive that acts: less of a smaller one is no less."""
        return 1.0 / min(max(self.columns.acting(models), _NO_DRIVE), 1.0)

    def held_out(self, models: Models) -> Array:
        """Squares of each block that a set leaves, fitted to the other folds, shape (B,)."""
        if not models:
            return self.nothing
        n = len(self.experiment.target)
        x, low, high, _ = self.stacked(models)
        r, k = self.experiment.residual, x.shape[1]
        i, j = np.triu_indices(k)
        gram = np.zeros((len(self.nothing), k, k))
        gram[:, i, j] = gram[:, j, i] = self.blocks.sums(x[:n, i] * x[:n, j])
        moment = self.blocks.sums(x[:n] * r[:n, None])
        whole, all_moments = x.T @ x, x.T @ r
        z = held_out_of(gram, moment, whole, all_moments, self.blocks.fold, low, high)
        explained = 2.0 * np.sum(moment * z, 1) - np.einsum("bij,bi,bj->b", gram, z, z)
        return np.asarray((self.nothing - explained) * self._over_drive(models))


def held_out_of(
    gram: Array, moment: Array, whole: Array, moments: Array, fold: Index, low: Array, high: Array
) -> Array:
    """Coefficients for each block, fitted to all but its fold, shape (B, k).

    Args:
        gram, moment: of each block, shapes (B, k, k) and (B, k). whole, moments: of all blocks and
            the prior's rows. fold: of each block, shape (B,). low, high: of each coefficient.
    """
    found = np.empty_like(moment)
    for k in np.unique(fold):
        own = fold == k
        rest = whole - gram[own].sum(0), moments - moment[own].sum(0)
        found[own] = _solved(*rest, low, high)
    return found


def _solved(gram: Array, moment: Array, low: Array, high: Array) -> Array:
    """Least squares from a Gram matrix, the coefficients within their range."""
    z = np.linalg.solve(gram + _REGULAR * np.eye(len(gram)), moment)
    beyond = (z < low) | (z > high)
    if beyond.any() and not beyond.all():  # what stays open makes up for what is on its bound
        z = np.clip(z, low, high)
        free = ~beyond
        own = gram[np.ix_(free, free)] + _REGULAR * np.eye(int(free.sum()))
        z[free] = np.linalg.solve(own, moment[free] - gram[np.ix_(free, beyond)] @ z[beyond])
    return np.asarray(np.clip(z, low, high))


class Gain(NamedTuple):
    """What a set predicts better than another.

    Attributes:
        part: of the squares. errors: over its paired standard error. torque: over friction's rms.
    """

    part: float
    errors: float
    torque: float


def gain(before: Array, after: Array, friction: float) -> Gain:
    """Compare squares of blocks, shape (B,) each; `friction` is the root of friction's squares."""
    less = before - after
    error = float(np.std(less)) * np.sqrt(len(less)) + 1e-300
    total = float(less.sum())
    return Gain(
        total / max(float(before.sum()), 1e-300),
        total / error,
        float(np.sqrt(max(total, 0.0))) / friction,
    )
