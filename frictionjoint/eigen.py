"""Eigenvalues of symmetric matrices."""

import numpy as np
import scipy.linalg

from frictionjoint.arrays import Array


def eigh(A: Array) -> tuple[Array, Array]:
    """As `numpy.linalg.eigh`, of matrices of shape (..., k, k).

    LAPACK's divide and conquer, which numpy calls, now and then does not converge on a matrix that
    has nothing wrong with it: that one is done by the slower QR iteration.
    """
    try:
        values, vectors = np.linalg.eigh(A)
    except np.linalg.LinAlgError:
        pairs = [scipy.linalg.eigh(one, driver="ev") for one in A.reshape(-1, *A.shape[-2:])]
        values = np.reshape([w for w, _ in pairs], A.shape[:-1])
        vectors = np.reshape([V for _, V in pairs], A.shape)
    return values, vectors
