"""Fit of the law alone: the result of `identify`, and the start and reference of `close-loop`."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import A
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import law_estimates
from frictionjoint.identify.rival_shape import forms_of, start_of
from frictionjoint.identify.rounding import in_order
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, Shape
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
    """A fit, or the best of other forms of its law if its residual is clearly smaller."""
    clear = [f for f in forms if f.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms]
    if not clear:
        return prepared, fitted
    return reweighed(prepared, in_order(clear, lambda f: f.drive_rms)[0])


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
    # the logs determine a stiffness with a standard error below half of it
    if known.stderr is not None and known.stderr < 0.5 * known.value:
        return fitted
    found = refit(prepared, fitted.effects, shape, ROUGH)
    return found if found.drive_rms <= fitted.drive_rms / (1.0 - CLEARLY) else fitted


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
