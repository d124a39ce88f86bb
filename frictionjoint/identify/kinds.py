"""Kinds of motion: groups of similar blocks of a log."""

import numpy as np
from scipy.cluster.vq import kmeans2

from frictionjoint.arrays import Array, Index


def kinds_of(rows: Array, most: int) -> Index:
    """Group of each row by k-means with normalised columns; the best of a few starts.

    Args:
        rows: shape (n, k). most: largest number of groups.
    Returns:
        shape (n,), numbers from 0; equal rows give equal groups.
    """
    spread = rows.std(axis=0)
    scaled = (rows - rows.mean(axis=0)) / np.where(spread > 0.0, spread, 1.0)
    count = min(most, len(np.unique(scaled, axis=0)))
    tries = []
    for seed in range(4):
        centres, found = kmeans2(scaled, count, iter=100, minit="++", rng=seed)
        tries.append((float(np.sum((scaled - centres[found]) ** 2)), seed, found))
    return np.asarray(min(tries)[2], dtype=np.int64)
