"""Paired confidence interval of a change in error, on the same samples.

The residuals of two models on the same motion are strongly correlated, so the interval of their
difference is far narrower than that of either error.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.identify.blocks import CORRELATION_TIMES, correlation_time
from frictionjoint.report.entries import Interval


def error_increase(before: Array, after: Array, log_index: NDArray[np.int64]) -> Interval:
    """95% interval of the difference of two rms errors on the same samples of logs, shape (n,).

    Blocks of time span several correlation times of the difference of the squared errors, if the
    log is long enough.
    """
    difference = after**2 - before**2
    parts: list[Array] = []
    for log in np.unique(log_index):
        own = difference[log_index == log]
        length = CORRELATION_TIMES * correlation_time(own)
        parts += np.array_split(own, max(1, round(len(own) / length)))
    sums, counts = np.array([x.sum() for x in parts]), np.array([len(x) for x in parts])
    return _interval(sums, counts, root_mean_square(before) + root_mean_square(after))


def replay_increase(before: Array, after: Array) -> Interval:
    """95% interval of the difference of two rms errors of free runs from the same states, from the
    mean square error of each run, shape (k,)."""
    both = float(np.sqrt(before.mean()) + np.sqrt(after.mean()))
    return _interval(after - before, np.ones(len(after)), both)


def _interval(sums: Array, counts: Array, both: float) -> Interval:
    """Interval of the difference of two rms values, from block sums of the difference of squares
    and the sum `both` of the two: a^2 - b^2 = (a - b) (a + b)."""
    blocks, n = len(sums), float(counts.sum())
    mean = float(sums.sum()) / n
    if blocks < 2 or not both:
        return -np.inf, np.inf
    spread = sums - mean * counts
    error = float(np.sqrt(blocks / (blocks - 1) * (spread @ spread))) / n
    # two-sided 95%
    half = float(stdtrit(blocks - 1, 0.975)) * error
    return (mean - half) / both, (mean + half) / both
