"""Gram matrices of all joints together: what shared columns explain of all residuals.

Each joint's own law is projected out of its columns, and its rows are scaled by its residual, so
that joints count equally. A sum of squares over joints is then a sum over stacked rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.diagnose.chance import surprise
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import lengths, pseudo_inverse, without
from frictionjoint.identify.blocks import folds_of
from frictionjoint.robot.clock import Clock

Columns = NDArray[np.int64]


@dataclass(frozen=True)
class JointGram:
    """Gram matrices of one joint.

    Attributes:
        grams: by block, the law projected out, the residual last, shape (B, c + 1, c + 1).
        columns: indices of its columns in the stack, shape (c,).
        name: of the joint. samples: number of its rows.
        left, friction: rms of its residual and of its friction, N m, both weighted.
        unreached: sum of squares of each block that would vanish to first order, (B,).
    """

    name: str
    samples: int

    grams: Array = field(repr=False)
    columns: Columns
    left: float
    friction: float
    unreached: Array = field(repr=False)


def joint_gram(
    law: Array, columns: Array, residual: Array, of_block: Columns, blocks: int
) -> Array:
    """Gram matrices by block with the law's columns projected out, shape (B, c + 1, c + 1).

    Args:
        law: shape (n, p); columns: (n, c); residual: (n,), with equal weights.
        of_block: block of each sample, shape (n,). blocks: their number.
    """
    U = np.column_stack([columns, residual])
    before = np.linalg.norm(U, axis=0)
    U = without(U, law / lengths(law))
    # what the law explains whole leaves rounding
    # part of a column, below which nothing is left of it
    U[:, np.linalg.norm(U, axis=0) < 1e-6 * before] = 0.0
    grams = np.zeros((blocks, U.shape[1], U.shape[1]))
    order = np.argsort(of_block, kind="stable")
    edges = np.searchsorted(of_block[order], np.arange(blocks + 1))
    for b in range(blocks):
        rows = U[order[edges[b] : edges[b + 1]]]
        grams[b] = rows.T @ rows
    return grams


class Stack:
    """Gram matrices of all joints.

    Args:
        joints: one each. clock: the blocks.
        precision: of the prior of each column's coefficient, shape (size,), 0 without a prior.
        pull: precision times mean of that prior, shape (size,).
    """

    def __init__(
        self, joints: Sequence[JointGram], clock: Clock, precision: Array, pull: Array
    ) -> None:
        self.joints = tuple(joints)
        self.clock = clock
        self.precision, self.pull = precision, pull
        self.size = len(precision)
        self.squares = np.array([j.grams[:, -1, -1] + j.unreached for j in joints])
        # where each joint has a column of the stack, -1 where it has not
        self._places = np.full((len(self.joints), self.size), -1)
        for k, joint in enumerate(self.joints):
            self._places[k, joint.columns] = np.arange(len(joint.columns))
        self.folds = folds_of(clock.fold)
        self.outside = np.array([self._sum(inside == 0.0) for inside in self.folds.inside])
        self.total = self._sum(np.ones(clock.count, dtype=bool))

    def _sum(self, blocks: NDArray[np.bool_]) -> Array:
        """The whole stack's matrix over some blocks, the residual last."""
        G = np.zeros((self.size + 1, self.size + 1))
        for joint in self.joints:
            at = np.append(joint.columns, self.size)
            G[np.ix_(at, at)] += joint.grams[blocks].sum(axis=0)
        columns = np.arange(self.size)
        G[columns, columns] += self.precision
        G[-1, :-1] += self.pull
        G[:-1, -1] += self.pull
        return G

    def held_out(self, at: Columns) -> Array:
        """Sum of squares of each joint and block, (J, B), fitted without the block's fold."""
        left = self.squares.copy()
        betas = least_squares(self.outside[:, at[:, None], at], self.outside[:, at, -1])
        # of each block, those fitted without its fold
        beta = betas[self.folds.place]
        for k, joint in enumerate(self.joints):
            here = self._places[k, at] >= 0
            own, weights = self._places[k, at[here]], beta[:, here, None]
            along = joint.grams[:, own[:, None], own] @ weights
            along -= 2.0 * joint.grams[:, own, -1:]
            left[k] += np.sum(weights * along, axis=(1, 2))
        return left

    def solution(self, at: Columns) -> Array:
        """Coefficients of columns fitted to the residuals, shape (k,)."""
        return least_squares(self.total[np.ix_(at, at)], self.total[at, -1])

    def deviation(self, at: Columns) -> float:
        """Squared coefficients, fitted together, over their prior variances."""
        own = self.precision[at] > 0.0
        precision = self.precision[at][own]
        x = self.solution(at)[own] - self.pull[at][own] / precision
        return float(precision @ x**2) / self.clock.alike

    def covariance(self, at: Columns) -> Array:
        """Covariance of coefficients without priors, (k, k); blocks of time are independent."""
        G = self.total[np.ix_(at, at)] - np.diag(self.precision[at])
        scale = roots(G)
        values, vectors = eigh(G / np.outer(scale, scale))
        # directions of smaller eigenvalues are undetermined, and numbers that contain them
        determined = values > 1e-8 * values[-1]
        inverse = (vectors[:, determined] / values[determined]) @ vectors[:, determined].T
        scores = self.products(at, np.zeros(0, dtype=np.int64))[1] / scale
        blocks = len(scores)
        spread = scores.T @ scores * blocks / max(1, blocks - len(at))
        cov = (inverse @ spread @ inverse) / np.outer(scale, scale)
        open_ones = np.sum(vectors[:, ~determined] ** 2, axis=1) > 1e-4
        cov[open_ones, open_ones] = np.inf
        return np.asarray(cov)

    def products(self, at: Columns, known: Columns) -> tuple[Array, Array]:
        """Gram matrices of columns by block, others projected out, shape (B, k, k), and products
        with the residual, shape (B, k), both summed over joints."""
        G = self.total
        inner = G[np.ix_(known, known)]
        scale = roots(inner)
        inverse = pseudo_inverse(inner / np.outer(scale, scale))
        right = G[np.ix_(known, np.append(at, self.size))] / scale[:, None]
        both = np.concatenate([known, at])
        # what the columns and the residual are of those of the stack, and of the residual itself
        less = np.zeros((len(both) + 1, len(at) + 1))
        less[: len(known)] = -(inverse @ right) / scale[:, None]
        less[len(known) :] = np.eye(len(at) + 1)
        grams = np.zeros((self.clock.count, len(at) + 1, len(at) + 1))
        for k, joint in enumerate(self.joints):
            here = np.flatnonzero(self._places[k, both] >= 0)
            own = np.append(self._places[k, both[here]], -1)
            part = less[np.append(here, len(both))]
            grams += part.T @ joint.grams[:, own[:, None], own] @ part
        return grams[:, :-1, :-1], grams[:, :-1, -1]

    def surprise(self, at: Columns, known: Columns, room: Array, signs: Array) -> Array:
        """Score of columns together with others, observed and by chance, see `diagnose.chance`;
        `room`: possible change of each coefficient in either direction, shape (k, 2), no limit if
        empty; `signs`: of each block, shape (flips, B)."""
        A, b = self.products(at, known)
        total = A.sum(axis=0) + np.diag(self.precision[at])
        scale = roots(total)
        A, b, total = A / np.outer(scale, scale), b / scale, total / np.outer(scale, scale)
        outside = least_squares(total - self.folds.sums(A), b.sum(axis=0) - self.folds.sums(b))
        elsewhere = outside[self.folds.place]
        free = np.full(len(at), np.inf)
        low, high = room.T * scale if len(room) else (-free, free)
        return surprise(A, b, elsewhere, total, (low, high), signs, self.clock.log)


def least_squares(A: Array, b: Array) -> Array:
    """Shortest solutions of normal equations: A of shape (..., k, k), b and result (..., k)."""
    if not b.shape[-1]:
        return b
    scale = roots(A)
    scaled = A / (scale[..., :, None] * scale[..., None, :])
    inverse = pseudo_inverse(scaled)
    return np.asarray((inverse @ (b / scale)[..., None])[..., 0] / scale)


def roots(A: Array) -> Array:
    """Square roots of the diagonals of Gram matrices, 1 for zero columns, shape (..., k)."""
    diagonal = np.diagonal(A, axis1=-2, axis2=-1)
    return np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
