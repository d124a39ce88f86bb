"""What the logs determine: the size of an effect, and whether a wrong mass is an encoder zero."""

from collections.abc import Mapping

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.decisions import SURELY
from frictionjoint.diagnose.candidate import is_unnamed
from frictionjoint.effects.signals import GX, GY, LOAD, A, parts_of_load
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import Term


def undetermined(prepared: Prepared, fitted: Fit) -> dict[Term, float]:
    """Effects whose sizes are within two standard errors of zero, and the distance of each."""
    asked = [i for i, t in enumerate(fitted.effects) if not (is_unnamed(t) or t.effect.first)]
    if not asked:
        return {}
    cov = stated_covariance(prepared, fitted)
    distances = {fitted.effects[i]: standard_errors(fitted, cov, i) for i in asked}
    return {term: x for term, x in distances.items() if x < SURELY}


def position_is_open(prepared: Prepared, fitted: Fit, i: int) -> bool:
    """Whether the logs leave a position of the i-th effect open by half of their travel.

    So it is if no log reaches one of two end stops.
    """
    at, effect = fitted.layout.numbers(i), fitted.terms[i].effect
    positions = np.array(effect.shape_units[effect.shape_fixed :]) == "x"
    errors = _errors(stated_covariance(prepared, fitted), at)
    return bool(np.any(errors[positions] >= 0.5 * prepared.span))


def standard_errors(fitted: Fit, cov: Array, i: int) -> float:
    """Distance of the i-th effect from zero size, in standard errors.

    The size is that of its best determined coefficient; of a slow change, at the rate that was
    found, because it is certain long before its end and its rate are known. For an effect without
    coefficients it is that of its shape numbers, see `Effect.vanishes`.

    Args:
        cov: of all parameters of the fit, in the order of its Jacobian.
    """
    term, layout = fitted.terms[i], fitted.layout
    at = layout.coefficients(i)
    if at.stop > at.start and not term.effect.of_load:
        x = np.asarray(fitted.beta[at])
        # a motor constant whose load may be absent from the torque is none
        x = np.minimum(np.abs(x), 1.0 + x) if term.effect.scales else x
        cov = _given(cov, layout.numbers(i)) if term.effect.slow else cov
    else:
        x, at = np.array(term.free_shape), layout.numbers(i)
        if term.effect.vanishes:
            name, none = term.effect.vanishes
            k = term.effect.shape.index(name) - term.effect.shape_fixed
            x, at = x[k : k + 1] - none, slice(at.start + k, at.start + k + 1)
    if not len(x):
        return np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        sure = np.abs(x) / _errors(cov, at)
    return float(np.max(np.where(np.isnan(sure), np.inf, sure)))


def _given(cov: Array, at: slice) -> Array:
    """Covariance of all parameters if some of them are known."""
    k = np.arange(len(cov))[at]
    k = k[np.isfinite(cov[k, k]) & (cov[k, k] > 0.0)]
    return cov - cov[:, k] @ np.linalg.solve(cov[np.ix_(k, k)], cov[k]) if k.size else cov


def _errors(cov: Array, at: slice) -> Array:
    """Standard errors of some parameters, infinite where the logs do not determine them."""
    variance = np.diag(cov)[at]
    return np.sqrt(np.where(np.isfinite(variance), np.maximum(variance, 0.0), np.inf))


def offset_instead(prepared: Prepared, found: Mapping[str, Estimate]) -> float | None:
    """Offset of the encoder, rad, that explains the logs as well as a gravity error; or None.

    An encoder zero that is off turns gravity, so a single joint shows it as a wrong mass. It does
    if the first moment of mass, with the error, is the model's own, turned about the axis.

    Args:
        found: first moments of the gravity error by name, kg m.
    """
    x, y = found.get("moment_x"), found.get("moment_y")
    if prepared.slide or x is None or y is None or x.stderr is None or y.stderr is None:
        return None
    signals = np.concatenate([s.signals for s in prepared.segments])
    parts = parts_of_load(signals)
    load = signals[:, LOAD]
    # moments that change, because joints beyond this one move, do not turn as one
    if root_mean_square(load - signals[:, [A, GX, GY]] @ parts) > 0.01 * root_mean_square(load):
        return None
    own, true = complex(*parts[1:]), complex(*parts[1:]) + complex(x.value, y.value)
    error = SURELY * np.hypot(x.stderr, y.stderr)
    # a model states masses and lengths to about 1%
    if abs(own) < error or abs(abs(true) - abs(own)) > max(error, 0.01 * abs(own)):
        return None
    return float(np.angle(own / true))
