"""Intervals from samples that are not independent: of parameters, and of an rms."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.nonsmooth_errors import with_leaps
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.uncertainty import covariance


@lru_cache(maxsize=8)
def stated_covariance(prepared: Prepared, fitted: Fit) -> Array:
    """Covariance of a fit's parameters for the report, by its own blocks.

    See `covariance`; for parameters with discontinuous torque `with_leaps`.
    """
    block = make_blocks(prepared, fitted).of_sample
    return with_leaps(prepared, fitted, covariance(prepared, fitted, block), block)


def rms_interval(e: Array, block: NDArray[np.int64]) -> tuple[float, float]:
    """95% interval of the rms of e, shape (n,), by bootstrap over blocks of time.

    Args:
        block: the block each sample belongs to, shape (n,).
    """
    rng = np.random.default_rng(0)
    _, block = np.unique(block, return_inverse=True)
    sums, counts = np.bincount(block, e**2), np.bincount(block)
    draws = rng.integers(0, len(sums), size=(400, len(sums)))
    sample = np.sqrt(sums[draws].sum(axis=1) / counts[draws].sum(axis=1))
    low, high = np.quantile(sample, (0.025, 0.975))
    return float(low), float(high)
