"""Sample weights from the fitted law: samples that the encoder does not resolve count less.

While a contact sticks, its torque depends strongly on the position: an encoder error dq changes it
by K dq, up to the whole level. In addition, every law is wrong there by a few per cent of the
level. In sliding neither error matters. Both errors follow from a fitted law, so rest below the
encoder's resolution needs no separate rule.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.search import CLOSE, refit
from frictionjoint.identify.segment import Prepared

# error of any law between sticking and sliding, over the level. Laws fitted to plants that have
# another law leave 3 to 10% of the level there.
STICKING_ERROR = 0.05
# largest change of an exponentially saturating torque, over its level, per part of its stiffness
_PER_STIFFNESS = np.exp(-1.0)


class Errors(NamedTuple):
    """rms residual of a fit, N m, in sliding and in sticking."""

    sliding: float
    sticking: float


def reweighed(prepared: Prepared, fitted: Fit, closeness: float = CLOSE) -> tuple[Prepared, Fit]:
    """The logs with weights from a fit, and the fit repeated with these weights."""
    prepared = weighted(prepared, fitted, errors_of(prepared, fitted))
    return prepared, refit(prepared, fitted.terms, fitted.shape, closeness)


def errors_of(prepared: Prepared, fitted: Fit) -> Errors:
    """Residuals of a fit in sliding and in sticking."""
    return _errors(prepared, _sticking(prepared, fitted), fitted.residual)


def _errors(prepared: Prepared, sticking: Sequence[Array], residual: Array) -> Errors:
    """Residuals of a model, by the fraction of each sample that sticks."""
    pairs = zip(prepared.segments, sticking, strict=True)
    stuck = np.concatenate([s.at_kept(x) for s, x in pairs])
    sliding, sticks = residual[stuck < 0.05], residual[stuck > 0.5]
    base = root_mean_square(sliding) if sliding.size else root_mean_square(residual)
    return Errors(base, root_mean_square(sticks) if sticks.size else 0.0)


def inverse_likelihood(prepared: Prepared, fitted: Fit) -> float:
    """Inverse of the likelihood per sample, geometric mean, if each residual has the variance that
    the weights from the fit imply; in `error_unit`."""
    errors = errors_of(prepared, fitted)
    spread = errors.sliding / weighted(prepared, fitted, errors).weight
    squares = (fitted.residual / spread) ** 2
    return float(np.exp(np.mean(0.5 * squares + np.log(spread / fitted.error_unit))))


def errors_elsewhere(prepared: Prepared, fitted: Fit, cov: Array) -> Errors:
    """Expected residuals of a fit, with a covariance of its parameters, on logs other than the
    fitted ones: those with almost no sticking determine no stiffness, and no friction at rest."""
    found = errors_of(prepared, fitted)
    stiffness = law_estimates(fitted, cov, prepared.slide)["stiffness"]
    error = np.inf if stiffness.stderr is None else stiffness.stderr / stiffness.value
    unknown = fitted.levels[0] * min(1.0, _PER_STIFFNESS * error)
    return found._replace(sticking=max(found.sticking, float(np.hypot(found.sliding, unknown))))


def weighted(prepared: Prepared, fitted: Fit, errors: Errors) -> Prepared:
    """Logs with sample weights from a fitted law, relative to the error of the fitted logs in
    sliding; the error in sticking is at least that."""
    law = law_parameters(fitted)
    level = fitted.levels[0]
    unresolved = [min(law.stiffness * s.noise.resolution, level) for s in prepared.segments]
    return _weighed(prepared, _sticking(prepared, fitted), unresolved, level, errors)


def weighted_by(
    prepared: Prepared,
    fractions: Sequence[Array],
    stiffnesses: Sequence[Array],
    level: float,
    residual: Array,
    rest_unknown: bool,
) -> Prepared:
    """Logs with sample weights before any law is fitted, from the fractions of the friction that
    stick along each log, their stiffnesses, N m/rad, the level of friction at rest, and the
    residual of the balance on the kept samples of all logs. With `rest_unknown`, friction at rest
    may be off by its level."""
    stuck = _behind_filter(prepared, fractions)
    pairs = zip(prepared.segments, stiffnesses, strict=True)
    unresolved = [np.minimum(k * s.noise.resolution, level) for s, k in pairs]
    errors = _errors(prepared, stuck, residual)
    if rest_unknown:
        errors = errors._replace(sticking=level)
    return _weighed(prepared, stuck, prepared.smooth(unresolved), level, errors)


def _weighed(
    prepared: Prepared,
    sticking: Sequence[Array],
    unresolved: Sequence[Array | float],
    level: float,
    errors: Errors,
) -> Prepared:
    """Weights from the torque, N m, of sticking parts that the encoder does not resolve."""
    base = errors.sliding or 1e-300
    weights = []
    for s, stuck, missed in zip(prepared.segments, sticking, unresolved, strict=True):
        known = missed**2 + (STICKING_ERROR * level) ** 2
        variance = stuck * np.maximum(known, errors.sticking**2 - base**2)
        if s.unknown is not None:
            variance = variance + s.undecimated(np.abs(s.unknown)) ** 2
        weights.append(1.0 / np.sqrt(1.0 + variance / base**2))
    return prepared.weighed(weights)


def _sticking(prepared: Prepared, fitted: Fit) -> list[Array]:
    """Square of dz/dq, 1 in sticking and 0 in sliding, after the balance's filter, (n,) each."""
    return _behind_filter(prepared, [rate for _, rate in prepared.tracks(fitted.shape)])


def _behind_filter(prepared: Prepared, fractions: Sequence[Array]) -> list[Array]:
    """Squares of sticking fractions after the filter of the balance."""
    squares = []
    for s, fraction in zip(prepared.segments, fractions, strict=True):
        stuck = np.minimum(np.abs(fraction), 1.0)
        # slower than the encoder resolves, the direction of the next displacement is not known
        slowest = s.noise.resolution * 2.0 * np.pi * s.corner_hz
        stuck[np.abs(s.signals[:, V]) < slowest] = 1.0
        squares.append(stuck**2)
    return [np.clip(x, 0.0, 1.0) for x in prepared.smooth(squares)]
