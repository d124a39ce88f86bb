"""Orthonormal bases of tall matrices with few columns."""

import numpy as np
from scipy.linalg import qr

from frictionjoint.arrays import Array
from frictionjoint.eigenvalues import eigh

# eigenvalues of a Gram matrix below this fraction of the largest: its columns depend on each other
DEPENDENT = 1e-8


def orthonormal(X: Array) -> Array:
    """Orthonormal basis, shape (n, rank), of columns with similar norms, possibly none, (n, k)."""
    if not X.shape[1]:
        return X
    basis, triangle, _ = qr(X, mode="economic", pivoting=True, check_finite=False)
    sizes = np.abs(np.diag(triangle))
    # smaller ones are rounding
    return np.asarray(basis[:, sizes > 1e-5 * sizes[0]])


def pseudo_inverse(A: Array, rcond: float = DEPENDENT) -> Array:
    """Pseudo-inverse of symmetric matrices, shape (..., k, k), twice as fast as numpy's;
    eigenvalues below `rcond` times the largest count as zero."""
    values, vectors = eigh(A)
    size = np.abs(values)
    large = size > rcond * size.max(axis=-1, keepdims=True, initial=0.0)
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=large)
    return np.asarray((vectors * inverse[..., None, :]) @ np.swapaxes(vectors, -1, -2))


def without(X: Array, known: Array) -> Array:
    """Columns, (n,) or (n, k), with others of similar norms, (n, m), if any, projected out."""
    # columns in memory one after the other, as `Blocks.gram` reads them
    rows = np.array(X.T, order="C")
    take_out(rows, known)
    return np.asarray(rows.T)


def take_out(rows: Array, known: Array) -> None:
    """`without` for rows, shape (n,) or (k, n), in place."""
    basis = orthonormal(known)
    shares = rows @ basis
    # in parts, as all of them at once may be hundreds of megabytes
    for first in range(0, len(basis), 8192):
        rows[..., first : first + 8192] -= shares @ basis[first : first + 8192].T


def lengths(X: Array) -> Array:
    """Norms of the columns for scaling: 1 for zero columns, shape (k,)."""
    norm: Array = np.linalg.norm(X, axis=0)
    norm[norm == 0.0] = 1.0
    return norm
