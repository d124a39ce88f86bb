"""The parametric law with the named effects, fitted last, as `identify` fits it.

The law is fitted from all its starts together with the effects, under the weights of the search,
which favour no explanation; then the weights follow from the fit.
"""

import numpy as np

from frictionjoint.diagnose.nearest import Replayed, nearer
from frictionjoint.identify.base_fit import best_form, with_assumed_stiffness
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.last_freedoms import with_last_freedoms
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.search import nearer as nearer_law
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import settled
from frictionjoint.identify.terms import Term, all_but
from frictionjoint.identify.weights import reweighed
from linear_search.decisions import CLEAR_TORQUE, DETERMINED, LEAST_TORQUE, NEEDED_PART
from linear_search.experiment import Experiment

# weights and fits in turn, at most
_WEIGHINGS = 4


def weighed(own: Experiment) -> Prepared:
    """The logs with the weights of the search, interpolated between the kept samples."""
    weights = []
    for i, s in enumerate(own.prepared.segments):
        kept = s.step * np.flatnonzero(s.kept)
        weights.append(np.interp(np.arange(len(s.drive)), kept, own.weight[own.blocks.log == i]))
    return own.prepared.weighed(weights)


def together(own: Experiment, law: str, terms: tuple[Term, ...], base: Fit) -> tuple[Prepared, Fit]:
    """The law with effects, from all its starts and from the law alone, with weights of its own."""
    prepared, fitted = best_form(weighed(own), law, terms)
    prepared, fitted = _with_its_weights(prepared, fitted)
    other = refit(prepared, fitted.effects, base.shape, ROUGH)
    if other.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms:
        return _with_its_weights(prepared, other)
    return prepared, fitted


def _with_its_weights(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """Weights and a fit that follow from each other.

    The first weights are those of the law's columns, whose stiffness is coarse: some samples count
    too much or too little, which hides contact damping.
    """
    for _ in range(_WEIGHINGS):
        before = fitted.drive_rms
        prepared, fitted = reweighed(*settled(prepared, fitted))
        if abs(fitted.drive_rms - before) < CLEARLY * before:
            break
    return prepared, fitted


def squares_of(fitted: Fit) -> float:
    """Weighted squares that a fit leaves, in a unit that no smaller drive makes less."""
    return len(fitted.residual) * fitted.drive_rms**2


def without(prepared: Prepared, fitted: Fit, term: Term, base: Fit) -> Fit:
    """The fit without an effect, at equal weights, from the nearer of the law's two places."""
    rest = all_but(fitted.effects, term)
    law = nearer_law(prepared, rest, (fitted.shape, base.shape))
    return refit(prepared, rest, law, ROUGH)


def eliminated(prepared: Prepared, final: Fit, base: Fit) -> tuple[Prepared, Fit]:
    """The fit without effects that the parametric law makes up for, or that are not determined."""
    friction = float(np.sum((final.friction * final.weight) ** 2)) / final.error_unit**2
    while final.effects:
        rows = []
        for k, term in enumerate(final.effects):
            fewer = without(prepared, final, term, base)
            less = squares_of(fewer) - squares_of(final)
            part = less / max(squares_of(fewer), 1e-300)
            torque = float(np.sqrt(max(less, 0.0) / max(friction, 1e-300)))
            needed = (part > NEEDED_PART and torque > LEAST_TORQUE) or torque > 2.0 * CLEAR_TORQUE
            rows.append((needed, part, k, fewer))
        idle = [r for r in rows if not r[0]]
        if not idle:
            over = over_errors(prepared, final)
            idle = [r for r in rows if over[r[2]] < DETERMINED]
        if not idle:
            break
        prepared, final = reweighed(prepared, min(idle, key=lambda r: r[1])[3])
    return prepared, final


def moving(prepared: Prepared, final: Fit, base: Fit, replayed: Replayed) -> tuple[Prepared, Fit]:
    """The fit without effects that worsen the simulated motion by more than they explain torque."""
    while final.effects:
        now = replayed(prepared, final)
        if now is None:
            break
        least, best = now.sum() * final.drive_rms**2, None
        for term in final.effects:
            other = without(prepared, final, term, base)
            errors = replayed(prepared, other)
            if errors is None or not nearer(errors, now) or np.median(now - errors) <= 0.0:
                continue
            product = errors.sum() * other.drive_rms**2
            if product < least:
                least, best = product, other
        if best is None:
            break
        prepared, final = reweighed(prepared, best)
    return prepared, final


def freed(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """With contact damping and one curve per direction decided, and the weights of that."""
    found = with_last_freedoms(prepared, fitted)
    return (prepared, fitted) if found is fitted else _with_its_weights(prepared, found)


def finished(prepared: Prepared, fitted: Fit) -> Fit:
    """With an assumed stiffness where the logs determine none."""
    return with_assumed_stiffness(prepared, fitted, stated_covariance)


def over_errors(prepared: Prepared, fitted: Fit) -> list[float]:
    """Of each effect the largest of its coefficients, or of its times, over its standard error."""
    cov = stated_covariance(prepared, fitted)
    found = []
    for k, term in enumerate(fitted.effects):
        places = fitted.layout.coefficients(k)
        values = fitted.beta[places]
        if not term.coefficients:  # a delay
            places, values = fitted.layout.numbers(k), np.array(term.free_shape)
        errors = np.sqrt(np.maximum(np.diag(cov)[places], 1e-300))
        found.append(float(np.max(np.abs(values) / errors)))
    return found
