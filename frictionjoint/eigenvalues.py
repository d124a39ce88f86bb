"""Eigenvalues of symmetric matrices."""

import numpy as np
import scipy.linalg

from frictionjoint.arrays import Array


def eigh(A: Array) -> tuple[Array, Array]:
    """Eigenvalues and eigenvectors as from `numpy.linalg.eigh`, for shape (..., k, k).

    LAPACK's divide and conquer method, which numpy calls, occasionally does not converge on a valid
    matrix. In that case the slower QR iteration is used.
    """
    try:
        values, vectors = np.linalg.eigh(A)
    except np.linalg.LinAlgError:
        pairs = [scipy.linalg.eigh(one, driver="ev") for one in A.reshape(-1, *A.shape[-2:])]
        values = np.reshape([w for w, _ in pairs], A.shape[:-1])
        vectors = np.reshape([V for _, V in pairs], A.shape)
    return values, vectors
