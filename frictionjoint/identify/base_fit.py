"""Fit of the law alone: the result of `identify`, and the start and reference of `close-loop`."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import GX, GY, LOAD, A
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.rival_shape import forms_of, start_of
from frictionjoint.identify.rounding import in_order
from frictionjoint.identify.search import ROUGH, Search, refit
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import INTEGRATED, IntegratedShape, Shape
from frictionjoint.identify.starts import law_alone, ripened
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed
from frictionjoint.rivals import StaticParameters
from frictionjoint.threads import one_thread

# how the integrated law acts in the log of a simulation with MuJoCo's own `frictionloss`
CONSTRAINT: tuple[Shape, ...] = (ConstraintShape(start_of(StaticParameters)),)


@one_thread
def base_fit(
    prepared: Prepared, law: str, progress: Callable[[str], None] = lambda text: None
) -> tuple[Prepared, Fit]:
    """The law alone, fitted to logs, with the weights that follow from it.

    The law has no contact damping and no assumed stiffness; both are decided last.

    Raises:
        ParameterError: no law has this name.
    """
    forms = forms_of(law)
    prepared, found = law_alone(prepared, forms, progress)
    if forms is not INTEGRATED:
        return prepared, found
    place = ripened(prepared, (), CONSTRAINT)[0]
    other = refit(prepared, (), place.search.split(place.x)[0], ROUGH)
    return better_form(prepared, found, [other])


def better_form(prepared: Prepared, fitted: Fit, forms: Sequence[Fit]) -> tuple[Prepared, Fit]:
    """A fit, or the best of other forms of its law if its residual is clearly smaller.

    A constraint whose lead ends where no simulation's does is not one: it replaces other dynamics.
    """
    clear = [
        f
        for f in forms
        if f.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms
        and not (isinstance(f.shape, ConstraintShape) and f.shape.at_an_end)
    ]
    if not clear:
        return prepared, fitted
    return reweighed(prepared, in_order(clear, lambda f: f.drive_rms)[0])


def with_assumptions(
    prepared: Prepared, fitted: Fit, covariance: Callable[[Prepared, Fit], Array]
) -> Fit:
    """The same fit with the stiffness and damping assumed that the logs do not determine."""
    return with_assumed_damping(prepared, with_assumed_stiffness(prepared, fitted, covariance))


def with_assumed_stiffness(
    prepared: Prepared, fitted: Fit, covariance: Callable[[Prepared, Fit], Array]
) -> Fit:
    """The same fit with an assumed stiffness, if the logs do not determine it.

    The assumed value is as high as the encoder's resolution and the time step allow (see
    `shortest`), so that the joint sticks. The logs determine a stiffness if its standard error is
    below half of its value, or if no other parameter of the law can compensate for the assumed
    value.

    Args:
        covariance: function of logs and fit that returns the covariance of its parameters.
    """
    shape = fitted.shape.with_assumed_stiffness(shortest(prepared))
    if isinstance(shape, ConstraintShape):
        return replace(fitted, shape=shape)
    # a stiffness without a torque holds nothing
    if not shape.assumed or not _holds(fitted):
        return fitted
    known = law_estimates(fitted, covariance(prepared, fitted), prepared.slide)["stiffness"]
    if not known.is_loose:
        return fitted
    found = refit(prepared, fitted.effects, shape, ROUGH)
    return found if found.drive_rms <= fitted.drive_rms / (1.0 - CLEARLY) else fitted


def with_assumed_damping(prepared: Prepared, fitted: Fit) -> Fit:
    """The same fit with an assumed damping sigma1, if the stuck joint would ring.

    A law with a soft presliding stiffness and no damping lets the joint oscillate at rest without
    end, because its first segment is elastic. The assumed value damps the joint critically, or
    half as much, or half of that and so on, until the logs allow it. A stiffness that is assumed
    needs none, because the time step damps it.
    """
    shape = fitted.shape
    if not isinstance(shape, IntegratedShape) or shape.assumed or not fitted.has_level:
        return fitted
    if shape.damped and fitted.coefficient("sigma1") > 0.0:
        return fitted
    level, viscosity = fitted.levels
    inertia = max(map(_inertia, prepared.segments))
    critical = 2.0 * math.sqrt(law_parameters(fitted).stiffness * max(inertia, 0.0))
    # a hundredth of the critical damping still brings a joint to rest within a hundred periods
    for part in (0.5**k for k in range(8)):
        wanted = part * critical - viscosity
        if wanted <= 0.0:
            break
        search = Search(prepared, fitted.terms, replace(shape, damping=wanted / level))
        found = search.result(search.start)
        # a residual that grows by 1% shows nothing; a joint that would never come to rest is worse
        # than a residual that is not clearly larger
        most = 1.01 if part > 0.02 else 1.0 / (1.0 - CLEARLY)
        if found.drive_rms <= most * fitted.drive_rms:
            return found
    return fitted


def _inertia(segment: Segment) -> float:
    """Mean inertia of the joint, kg m^2 (kg), next to what other joints' accelerations load on
    it."""
    others = [x for name, x in segment.others.items() if name.endswith(".acceleration")]
    columns = np.column_stack([segment.signals[:, [A, GX, GY]], *others])[segment.mask]
    load = segment.signals[segment.mask, LOAD]
    return float(np.linalg.lstsq(columns, load, rcond=None)[0][0])


def _holds(fitted: Fit) -> bool:
    """Whether the law has a Coulomb level, or an effect may replace it."""
    return fitted.has_level or any(isinstance(term, EffectTerm) for term in fitted.terms)


def shortest(prepared: Prepared) -> float:
    """The shortest displacement at a reversal that the logs resolve, rad (m).

    It is limited by the encoder's error, and by the distance that the joint moves within half a
    sample of a reversal at its usual acceleration.
    """

    def of_log(resolution: float, dt: float, a: Array) -> float:
        return max(resolution, 0.125 * root_mean_square(a) * dt**2)

    return min(
        of_log(s.noise.resolution, s.sample, s.signals[s.mask, A]) for s in prepared.segments
    )
