"""Optional parameters of a law that are decided last: contact damping, one curve per direction.

While effects are searched for, the law must not have these parameters, because they would absorb
missing effects. The filter of the torque balance removes most of the contact damping sigma1. With a
soft transition curve, sigma1 resembles viscous friction for a while after each reversal. Stribeck
curves that differ by direction resemble an asymmetry of the friction.
"""

from dataclasses import replace

from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, IntegratedShape


def with_last_freedoms(prepared: Prepared, fitted: Fit) -> Fit:
    """Add each of these parameters to the law if it clearly reduces the residual."""
    for free in (IntegratedShape.with_damping, IntegratedShape.by_direction):
        shape = fitted.shape
        if not isinstance(shape, IntegratedShape) or free(shape) == shape:
            continue
        found = refit(prepared, fitted.effects, free(shape))
        if found.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms:
            fitted = _best_form(prepared, found)
    return fitted


def _best_form(prepared: Prepared, fitted: Fit) -> Fit:
    """The model with the form of the integrated law that has the smallest residual.

    The best form can change when a parameter is added.
    """
    shape = fitted.shape
    assert isinstance(shape, IntegratedShape)
    others = [replace(shape, form=other.form) for other in INTEGRATED if other.form != shape.form]
    found = [refit(prepared, fitted.effects, other) for other in others]
    return best_of([fitted, *found], lambda f: f.drive_rms)
