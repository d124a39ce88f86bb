"""Fit of the law alone: the result of `identify`, and the start and reference of `close-loop`.

Some options of a law are decided last. A contact with sharp sliding follows its transition curve
until it slides, as elements that stick and slip do; the large exponent takes long, so no search has
it. Contact damping sigma1 and a Stribeck curve per direction would absorb effects that are searched
for. The filter of the torque balance removes most of sigma1, which with a soft transition curve
resembles viscous friction for a while after each reversal. Stribeck curves that differ by direction
resemble an asymmetry of the friction.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from frictionjoint.decisions import APART
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rival_shape import ConstraintShape, forms_of, start_of
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, IntegratedShape, Shape
from frictionjoint.identify.starts import law_alone, refined_starts
from frictionjoint.identify.weights import reweighed
from frictionjoint.rivals import StaticParameters
from frictionjoint.threads import one_thread

# how the integrated law acts in the log of a simulation with MuJoCo's own `frictionloss`
CONSTRAINT: tuple[Shape, ...] = (ConstraintShape(start_of(StaticParameters)),)


@one_thread
def base_fit(
    prepared: Prepared, law: str, progress: Callable[[str], None] = lambda text: None
) -> tuple[Prepared, Fit]:
    """The law alone, fitted to logs, with the weights that follow from it; it has no contact
    damping and no assumed stiffness, which are decided last. ParameterError: no law has this
    name."""
    forms = forms_of(law)
    prepared, found = law_alone(prepared, forms, progress)
    if slow_fit(prepared, found, forms):
        prepared, found = law_alone(replace(prepared, slow=True), forms, progress)
    if forms is not INTEGRATED:
        return prepared, found
    other = refit(prepared, (), refined_starts(prepared, (), CONSTRAINT)[0].law, ROUGH)
    return better_form(prepared, found, [other])


def slow_fit(prepared: Prepared, found: Fit, forms: Sequence[Shape]) -> tuple[Prepared, Fit] | None:
    """The logs and a fit without the usual bound of the Stribeck velocity; None unless the velocity
    is at that bound, and at most half of the sum of squares remains without it."""
    shape = found.shape
    if prepared.slow or "log Vs" not in shape.variables:
        return None
    at = shape.variables.index("log Vs")
    most = shape.bounds(prepared.bounding_speed, prepared.span)[1][at]
    if shape.vector()[at] < most - 0.01:
        return None
    slow = replace(prepared, slow=True)
    law = refined_starts(slow, found.effects, forms)[0].law
    # under the weights of a law that falls too early, much of what it leaves counts little
    slow, wide = reweighed(*reweighed(slow, refit(slow, found.effects, law)))
    bound = refit(replace(slow, slow=False), found.effects, shape)
    return (slow, wide) if wide.drive_rms**2 < APART * bound.drive_rms**2 else None


def better_form(prepared: Prepared, fitted: Fit, forms: Sequence[Fit]) -> tuple[Prepared, Fit]:
    """A fit, or the best of other forms of its law if its residual is clearly smaller.

    A constraint whose lead ends where no simulation's does is not one: it replaces other dynamics.
    """
    clear = [
        f
        for f in forms
        if f.clearly_better(fitted)
        and not (isinstance(f.shape, ConstraintShape) and f.shape.at_an_end)
    ]
    if not clear:
        return prepared, fitted
    return reweighed(prepared, in_order(clear, lambda f: f.drive_rms)[0])


def with_last_freedoms(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """Logs and fit with each of these options that clearly reduces the residual, reweighed as the
    law's error determines the weights."""
    found = _with_sharp_sliding(prepared, fitted)
    for free in (IntegratedShape.with_damping, IntegratedShape.by_direction):
        shape = found.shape
        if not isinstance(shape, IntegratedShape) or free(shape) == shape:
            continue
        freed = refit(prepared, found.effects, free(shape), ROUGH)
        if freed.clearly_better(found):
            found = freed
    return (prepared, fitted) if found is fitted else reweighed(prepared, found)


def _with_sharp_sliding(prepared: Prepared, fitted: Fit) -> Fit:
    shape = fitted.shape
    if not isinstance(shape, IntegratedShape) or shape.sharp:
        return fitted
    # a narrow and a wide Stribeck curve are local minima of their own
    found = [refit(prepared, fitted.effects, start, ROUGH) for start in shape.with_sharp_sliding()]
    best: Fit = best_of(found, lambda f: f.drive_rms)
    return best if best.clearly_better(fitted) else fitted
