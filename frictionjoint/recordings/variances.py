"""Variances of a parameter's estimates in several recordings, moderated by each other.

A recording of a few seconds has a dozen blocks of time, so its variance has five to ten degrees of
freedom: weights by it are noise, and too often the recordings seem to differ. What correlation in
time adds to the variance of independent samples is similar in all recordings of a joint. Empirical
Bayes (Smyth 2004, Stat. Appl. Genet. Mol. Biol. 3, 3) draws this factor towards its mean over the
recordings, completely if it varies no more than its degrees of freedom let it.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import digamma, polygamma

from frictionjoint.arrays import Array

# range of the prior's degrees of freedom, halved; beyond it the factors are equal
_LEAST, _MOST = 1e-3, 1e6


def moderated(block: Array, independent: Array, dof: Array) -> tuple[Array, float]:
    """Variances of k estimates, and the degrees of freedom of one, of all if the factors are equal.

    Args:
        block: variances from blocks of time, with `dof` degrees of freedom, shape (k,).
        independent: variances if samples were independent, shape (k,).
    """
    factor, half = block / independent, 0.5 * dof
    if len(block) < 2:
        return block, float(dof.sum())
    logs = np.log(factor) - digamma(half) + np.log(half)
    excess = float(np.var(logs, ddof=1) - np.mean(polygamma(1, half)))
    if excess <= polygamma(1, _MOST):
        return float(dof @ factor / dof.sum()) * independent, float(dof.sum())
    if excess >= polygamma(1, _LEAST):
        return block, float(dof.mean())
    prior = float(brentq(lambda x: polygamma(1, x) - excess, _LEAST, _MOST))
    centre = np.exp(logs.mean() + digamma(prior) - np.log(prior))
    both = 2.0 * prior + dof
    found = (2.0 * prior * centre + dof * factor) / both * independent
    return found, float(min(both.mean(), dof.sum()))
