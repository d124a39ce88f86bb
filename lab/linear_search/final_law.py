"""The parametric law, fitted last: started from the law's columns, with the named effects.

The levels of the elements at rest are the knots of the transition curve (Masing 1926), their falls
with speed are the Stribeck curve.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import CLOSE, ROUGH, Search, refit, timed
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import IntegratedShape, Shape
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import Term
from linear_search.experiment import Experiment

# torque of the knots over the curve's reach, see `shape`
_TORQUES = (0.5, 0.8, 0.98)
# steps of a start, and of the best
_STEPS, _LAST_STEPS = 8, 20
# starts of the linear fit that are followed
_FOLLOWED = 2


def weighed(own: Experiment) -> Prepared:
    """The logs with the weights of the search, interpolated between the kept samples."""
    weights = []
    for i, s in enumerate(own.prepared.segments):
        kept = s.step * np.flatnonzero(s.kept)
        weights.append(np.interp(np.arange(len(s.drive)), kept, own.weight[own.blocks.log == i]))
    return own.prepared.weighed(weights)


def parametric(
    prepared: Prepared, own: Experiment, terms: tuple[Term, ...], forms: Sequence[Shape]
) -> Fit:
    """A law with effects, from the linear fit and from a coarse look everywhere.

    Args:
        prepared: the logs, weighted. forms: of the law.
    """
    known = (form for form in forms if isinstance(form, IntegratedShape))
    starts = list(dict.fromkeys(started(own, form) for form in known))
    searches = [Search(prepared, timed(prepared, terms, shape), shape) for shape in starts]
    left = [search.squares(search.start) for search in searches]
    nearest = np.argsort(left, kind="stable")[:_FOLLOWED]
    fits = [refit(prepared, terms, starts[k], ROUGH, _STEPS) for k in nearest]
    everywhere = fit(prepared, terms, forms)
    best = min([everywhere, *fits], key=squares_of)
    if best is everywhere:
        return best
    return refit(prepared, best.effects, best.shape, CLOSE, _LAST_STEPS)


def squares_of(fitted: Fit) -> float:
    """Weighted squares that a fit leaves, in a unit that no smaller drive makes less."""
    return len(fitted.residual) * fitted.drive_rms**2


def started(own: Experiment, form: IntegratedShape) -> IntegratedShape:
    """The integrated law as the linear fit has it."""
    top, span = own.prepared.top_speed, own.prepared.span
    reaches = own.basis.reaches
    rest = np.maximum(own.basis.at_rest(own.coefficients), 0.0)
    Fs = max(float(rest.sum()), 1e-12)
    # of a reversal from sliding all displacements are twice those from rest
    z = np.geomspace(0.1 * reaches[0], 2.0 * reaches[-1], 2000)
    curve = np.minimum(z[:, None] / reaches, 2.0) @ rest / (2.0 * Fs)
    knots = [float(np.interp(x, curve, z)) for x in _TORQUES]
    steps = np.diff([0.0, *_TORQUES]) / np.maximum(np.diff([0.0, *knots]), 1e-12)
    bends = np.clip(steps[1:] / steps[:-1], 0.03, 0.98)

    v = np.geomspace(1e-4, 1.0, 400) * top
    S = own.basis.level_at(own.coefficients, v)
    Fc = float(np.clip(np.interp(0.4 * top, v, S), 0.2 * Fs, 0.98 * Fs))
    fall = np.clip((S - Fc) / max(float(S[0]) - Fc, 1e-12), 1e-3, 1.0)

    def falls_to(level: float) -> float:
        below = np.flatnonzero(fall < level)
        return float(v[below[0]] if below.size else v[-1])

    half = max(float(np.log(falls_to(0.2) / falls_to(0.7))), 1e-3)
    delta = float(np.log(np.log(5.0) / np.log(1.0 / 0.7))) / half
    return replace(
        form,
        excess=float(np.clip(Fs / Fc - 1.0, 0.02, 2.0)),
        Vs=float(np.clip(falls_to(float(np.exp(-1.0))), 2e-3 * top, 0.29 * top)),
        delta=float(np.clip(delta, 0.5, 2.5)),
        length=float(np.clip(knots[0], 2e-6 * span, 0.09 * span)),
        bend=(float(bends[0]), float(bends[1])),
    )
