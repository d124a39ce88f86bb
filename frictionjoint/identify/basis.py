"""Orthonormal directions of many samples and few columns."""

import numpy as np

from frictionjoint.arrays import Array

# of the largest eigenvalue of the Gram matrix, below which a direction is rounding
_DEPENDENT = 1e-10


def orthonormal(X: Array) -> Array:
    """Orthonormal columns of what X spans, shape (n, rank).

    Args:
        X: columns of about the same norm, or none, shape (n, k).
    """
    values, vectors = np.linalg.eigh(X.T @ X)
    independent = values > _DEPENDENT * values.max(initial=0.0)
    return np.asarray(X @ (vectors[:, independent] / np.sqrt(values[independent])))


def without(X: Array, known: Array) -> Array:
    """Columns with others projected out of them on all samples, shape as that of X.

    Args:
        X: shape (n,) or (n, k). known: of about the same norm, or none, shape (n, m).
    """
    basis = orthonormal(known)
    for _ in range(2):  # once leaves the rounding of the squares
        X = X - basis @ (basis.T @ X)
    return X
