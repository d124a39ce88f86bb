"""Orthonormal bases of tall matrices with few columns."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.eigenvalues import eigh


def orthonormal(X: Array) -> Array:
    """Orthonormal basis of the columns of X, shape (n, rank).

    Args:
        X: columns with similar norms, possibly none, shape (n, k).
    """
    values, vectors = eigh(X.T @ X)
    # smaller eigenvalues are rounding
    independent = values > 1e-10 * values.max(initial=0.0)
    return np.asarray(X @ (vectors[:, independent] / np.sqrt(values[independent])))


def pseudo_inverse(A: Array, rcond: float) -> Array:
    """Pseudo-inverse of symmetric matrices, shape (..., k, k), twice as fast as
    `numpy.linalg.pinv`.

    Args:
        rcond: eigenvalues below this fraction of the largest count as zero.
    """
    values, vectors = eigh(A)
    size = np.abs(values)
    large = size > rcond * size.max(axis=-1, keepdims=True, initial=0.0)
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=large)
    return np.asarray((vectors * inverse[..., None, :]) @ np.swapaxes(vectors, -1, -2))


def without(X: Array, known: Array) -> Array:
    """Columns with others projected out on all samples, shape as X.

    Args:
        X: shape (n,) or (n, k). known: with similar norms, possibly none, shape (n, m).
    """
    basis = orthonormal(known)
    for _ in range(2):  # once leaves the rounding of the squares
        X = X - basis @ (basis.T @ X)
    return X
