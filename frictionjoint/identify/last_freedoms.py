"""Options of a law that are decided last: sharp sliding, contact damping, a curve per direction.

A contact with sharp sliding follows its transition curve until it slides, as elements that stick
and slip do; the large exponent takes long, so no search has it. While effects are searched for, the
law must not have the other two, because they would absorb missing effects. The filter of the torque
balance removes most of the contact damping sigma1. With a soft transition curve, sigma1 resembles
viscous friction for a while after each reversal. Stribeck curves that differ by direction resemble
an asymmetry of the friction.
"""

from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import IntegratedShape
from frictionjoint.identify.weights import reweighed


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
