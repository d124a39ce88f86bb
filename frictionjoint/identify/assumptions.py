"""Assumed values of parameters that the logs do not determine, so that the model rests."""

import math
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import root_mean_square
from frictionjoint.decisions import SMALLEST_GAIN, SURELY
from frictionjoint.effects.signals import GEAR, A, V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import Estimate, law_estimates, law_parameters
from frictionjoint.identify.rival_shape import ConstraintShape
from frictionjoint.identify.search import ROUGH, Search, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import IntegratedShape
from frictionjoint.identify.terms import EffectTerm

# of a simulation, s
_TIME_STEP = 1e-3


def with_assumptions(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """The same logs and fit with assumptions about what the logs do not determine.

    A parameter that they do not determine may have any value in a fit, and a model with that value
    may creep, ring or jam at rest. An assumption is made if the residual is not clearly larger than
    without it.
    """
    for assume in (with_assumed_stiffness, with_assumed_breakaway):
        fitted = assume(prepared, fitted)
    # fitted with these, a level that the logs do not determine may vanish
    prepared, fitted = with_assumed_level(prepared, fitted)
    return prepared, with_steep_start(prepared, fitted)


def with_assumed_level(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """The same fit with an assumed Coulomb level, if friction would vanish with the load.

    A joint that is always loaded does not show the friction of its seals and preload. The assumed
    level is half of the friction by load, or half as much and so on, until the logs allow it.
    """
    loads = [i for i, t in enumerate(fitted.terms) if t.follows_law and GEAR in t.effect.needs]
    if fitted.has_level or not loads:
        return prepared, fitted
    by_load = root_mean_square(fitted.term_torque(loads[0])[fitted.in_motion]) / fitted.gain
    for part in (0.5, 0.25, 0.12, 0.06, 0.03):
        bounded = replace(prepared, least_level=part * by_load)
        found = refit(bounded, fitted.terms, fitted.shape, ROUGH)
        if not fitted.clearly_better(found):
            return bounded, found
    return prepared, fitted


def with_assumed_stiffness(prepared: Prepared, fitted: Fit) -> Fit:
    """The same fit with an assumed stiffness, if the logs do not determine it.

    The assumed value is as high as the encoder's resolution and the time step allow (see
    `shortest`), so that the joint sticks. The logs determine a stiffness if its standard error is
    below half of its value, or if no other parameter of the law can compensate for the assumed
    value. If they allow no such value, a higher one is assumed, at most that of the fit.
    """
    reach = shortest(prepared)
    shape = fitted.shape.with_assumed_stiffness(reach)
    if isinstance(shape, ConstraintShape):
        return replace(fitted, shape=shape)
    # a stiffness without a torque holds nothing; an effect may replace the Coulomb level
    holds = fitted.has_level or any(isinstance(term, EffectTerm) for term in fitted.terms)
    if not (shape.stiffness_assumed and holds and _law(prepared, fitted)["stiffness"].is_loose):
        return fitted
    assert isinstance(fitted.shape, IntegratedShape)
    own = min(reach, fitted.shape.length)
    # several of these are equal where the length of the fit is near the reach
    for length in dict.fromkeys(max(part * reach, own) for part in (1.0, 0.1, 0.01, 0.0)):
        shape = fitted.shape.with_assumed_stiffness(length)
        found = refit(prepared, fitted.effects, shape, ROUGH)
        if not fitted.clearly_better(found):
            return found
    return fitted


def with_steep_start(prepared: Prepared, fitted: Fit) -> Fit:
    """The same fit with an assumed steep beginning of the transition curve, if a stuck joint would
    ring.

    Within the first, elastic segment of a transition curve only sigma1 and viscous friction damp
    oscillations, while in real contacts every displacement dissipates (Al-Bender, Lampaert and
    Swevers 2005). With a steep part of half a percent of breakaway friction, displacements beyond
    its end dissipate, and smaller ones are damped by MuJoCo's time step, as is a curve of a high
    assumed stiffness, which needs no steeper beginning.
    """
    shape = fitted.shape
    if not isinstance(shape, IntegratedShape) or not fitted.has_level:
        return fitted
    _, viscosity = fitted.levels
    stiffness = law_parameters(fitted).stiffness
    damping = fitted.coefficient("sigma1") + viscosity
    damping += stiffness * _TIME_STEP * shape.stiffness_assumed
    inertia = max(s.inertia for s in prepared.segments)
    # with a tenth of the critical damping it comes to rest within a few periods
    if damping >= 0.1 * 2.0 * math.sqrt(stiffness * inertia):
        return fitted
    # a search could end in another minimum, where friction is viscous instead
    search = Search(prepared, fitted.terms, replace(shape, steep_start=True))
    found = search.result(search.start)
    return fitted if fitted.clearly_better(found) else found


def with_assumed_breakaway(prepared: Prepared, fitted: Fit) -> Fit:
    """The same fit with an assumed breakaway friction Fs, if the logs do not determine it.

    It is that of Coulomb friction, or as little above it as the logs allow. More than twice Coulomb
    friction is rare, so it must reduce the residual by more than chance.
    """
    if not fitted.has_level:
        return fitted
    shape, law = fitted.shape, _law(prepared, fitted)
    levels = [law[name] for name in ("Fs_pos", "Fs_neg") if name in law]
    # with a gain that the logs do not show the level may be none in N m
    if law["Fc_pos"].value <= 0.0 or not any(x.is_loose for x in levels):
        return fitted
    most = max(x.value for x in levels) / law["Fc_pos"].value - 1.0
    found, refused = fitted, []
    for excess in (*(x for x in (0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0) if x < most), most):
        tried = refit(prepared, fitted.effects, shape.with_assumed_breakaway(excess), ROUGH)
        if not fitted.clearly_better(tried):
            if excess <= 1.0:
                return tried
            found = tried
            break
        refused.append(tried)
    return next((x for x in refused if _by_chance(prepared, x, fitted)), found)


def _by_chance(prepared: Prepared, found: Fit, fitted: Fit) -> bool:
    """Whether chance explains that the residual with an assumption is larger than without.

    Motion begins once per stroke, so in a short log a few samples decide: the sum of squares must
    grow by two standard errors over the strokes, or by as much as an effect must remove.
    """
    first, last = ((x.residual * x.weight / x.error_unit) ** 2 for x in (fitted, found))
    reverses = np.diff(np.signbit(prepared.at_kept(V))) | (np.diff(fitted.log_index) > 0)
    more = np.bincount(np.append(0, np.cumsum(reverses)), last - first)
    if len(more) > 1 and more.sum() > SURELY * math.sqrt(len(more)) * more.std(ddof=1):
        return False
    return bool((1.0 - SMALLEST_GAIN) * last.sum() <= first.sum())


def _law(prepared: Prepared, fitted: Fit) -> dict[str, Estimate]:
    return law_estimates(fitted, stated_covariance(prepared, fitted), prepared.slide)


def shortest(prepared: Prepared) -> float:
    """The shortest displacement at a reversal that the logs resolve, rad (m).

    It is limited by the encoder's error, and by the distance that the joint moves within half a
    sample of a reversal at its usual acceleration.
    """
    return min(
        max(s.noise.resolution, 0.125 * root_mean_square(s.signals[s.mask, A]) * s.sample**2)
        for s in prepared.segments
    )
