"""How much a parameter differs between recordings, beyond the error of each estimate.

Random-effects meta-analysis: the estimate of recording i is y_i = mu + u_i + e_i, where e_i has a
standard error of its own and u_i has the variance tau^2 between recordings. tau^2 is estimated by
the method of DerSimonian and Laird (1986), the interval of the mean by that of Hartung and Knapp
(2001). Cochran's Q tests tau^2 = 0, as a ratio of variances: those of the estimates are estimates.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.special import digamma, fdtrc, polygamma, stdtr, stdtrit

from frictionjoint.arrays import Array
from frictionjoint.decisions import SIGNIFICANCE
from frictionjoint.recordings.estimate import Estimates

# range of the prior's degrees of freedom, halved; beyond it the factors are equal
_LEAST, _MOST = 1e-3, 1e6


class Between:
    """A parameter over several recordings.

    Args:
        value, stderr: of each recording, shape (k,), k >= 2, with `dof` degrees of freedom.
        causes: quantities that differ between recordings, shape (k,) each; NaN: left out.
    Attributes:
        mean: over recordings. interval: 95% interval of the mean.
        deviation: standard deviation between recordings, beyond the errors of the estimates.
        p_value: probability that the errors alone cause such a difference.
        stderr, dof: standard error of the mean and its degrees of freedom (Satterthwaite 1946).
        cause: quantity that explains most of the difference, "" for none.
        slope: change of the parameter per unit of the cause.
    """

    def __init__(
        self, value: Array, stderr: Array, dof: float, causes: dict[str, Array] | None = None
    ) -> None:
        k = len(value)
        deviation, Q = _deviation(value, stderr, np.ones((k, 1)))
        w = 1.0 / (stderr**2 + deviation**2)
        self.deviation = deviation
        self.mean = float(w @ value / w.sum())
        spread = float(w @ (value - self.mean) ** 2 / ((k - 1) * w.sum()))
        half = float(stdtrit(k - 1, 0.975) * np.sqrt(spread))
        self.interval = self.mean - half, self.mean + half
        self.p_value = float(fdtrc(k - 1, dof, Q / (k - 1)))
        errors = 1.0 / float(np.sum(stderr**-2.0))
        added = 1.0 / float(w.sum()) - errors
        self.stderr = float(np.sqrt(errors + added))
        self.dof = (errors + added) ** 2 / (errors**2 / dof + added**2 / (k - 1))
        self.cause, self.slope = "", 0.0
        # a cause is named from six recordings on
        if self.p_value < SIGNIFICANCE and k >= 6:
            self.cause, self.slope = _cause(value, stderr, deviation, causes or {})


def over(found: Sequence[Estimates], i: int) -> Between:
    """Parameter i over two recordings or more, and what its differences may be attributed to."""
    value, stderr, independent = (
        np.array([getattr(x, kind)[i] for x in found])
        for kind in ("value", "stderr", "independent")
    )
    variance, dof = moderated(stderr**2, independent**2, np.array([x.dof for x in found]))
    causes = {
        "temperature_c": np.array([x.temperature for x in found]),
        "speed": np.array([x.speed for x in found]),
        "direction": np.array([x.direction for x in found]),
        "order of the recordings": np.arange(len(found), dtype=float),
        "torque": np.array([x.load for x in found]),
    }
    return Between(value, np.sqrt(variance), dof, causes)


def _deviation(value: Array, stderr: Array, X: Array) -> tuple[float, float]:
    """tau from a weighted regression on X by moments, and Cochran's Q."""
    k, p = X.shape
    w = stderr**-2.0
    _, left, inverse = _regression(value, w, X)
    Q = float(w @ left**2)
    trace = float(w.sum() - np.trace(inverse @ (X.T * w * w) @ X))
    return float(np.sqrt(max(0.0, (Q - (k - p)) / trace))), Q


def _regression(value: Array, w: Array, X: Array) -> tuple[Array, Array, Array]:
    """Coefficients of a regression with weights w, its residual, and the inverse of X'WX."""
    XtW = X.T * w
    inverse = np.asarray(np.linalg.inv(XtW @ X), dtype=np.float64)
    coefficients = inverse @ (XtW @ value)
    return coefficients, value - X @ coefficients, inverse


def _cause(
    value: Array, stderr: Array, deviation: float, causes: dict[str, Array]
) -> tuple[str, float]:
    """The quantity that explains most of the difference, at least half, with a p-value below 1%."""
    best, found, k = 0.5, ("", 0.0), len(value)
    for name, x in causes.items():
        if not np.isfinite(x).all() or np.ptp(x) == 0.0:
            continue
        centred = x - x.mean()
        X = np.column_stack([np.ones_like(x), centred])
        left, _ = _deviation(value, stderr, X)
        w = 1.0 / (stderr**2 + left**2)
        coefficients, residual, inverse = _regression(value, w, X)
        slope = float(coefficients[1])
        scale = max(1.0, float(w @ residual**2) / (k - 2))
        p_value = 2.0 * float(stdtr(k - 2, -abs(slope) / np.sqrt(inverse[1, 1] * scale)))
        share = left**2 / deviation**2 if deviation > 0.0 else 1.0
        if p_value < 0.01 / len(causes) and share < best:
            best, found = share, (name, slope)
    return found


def moderated(block: Array, independent: Array, dof: Array) -> tuple[Array, float]:
    """Variances of k estimates of a parameter, and the degrees of freedom of one, of all if the
    factors between the two kinds of variances are equal.

    A recording of a few seconds has a dozen blocks of time: weights by its variance are noise, and
    too often recordings seem to differ. What correlation in time adds to the variance of
    independent samples is similar in all recordings of a joint. Empirical Bayes (Smyth 2004, Stat.
    Appl. Genet. Mol. Biol. 3, 3) draws this factor towards its mean over the recordings, completely
    if it varies no more than its degrees of freedom let it.

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
