"""Standard errors that hold on correlated residuals: the sandwich, summed over blocks of time."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit


def covariance(fitted: Fit, block_of_sample: NDArray[np.int64]) -> Array:
    """Covariance of the parameters in the order of the jacobian (White 1980, by cluster).

    Directions the logs say nothing about get an infinite variance.
    """
    J, e = fitted.jacobian, fitted.residual
    scale = np.linalg.norm(J, axis=0)
    dead = scale < 1e-12 * scale.max()
    scale[dead] = 1.0
    Js = J / scale
    bread = np.linalg.pinv(Js.T @ Js, rcond=1e-10, hermitian=True)
    edges = np.flatnonzero(np.diff(block_of_sample, prepend=-1))
    scores = np.add.reduceat(Js * e[:, None], edges, axis=0)
    blocks = len(edges)
    meat = scores.T @ scores * (blocks / max(1, blocks - 1))
    cov = bread @ meat @ bread / np.outer(scale, scale)
    cov[dead, dead] = np.inf
    return np.asarray(cov)
