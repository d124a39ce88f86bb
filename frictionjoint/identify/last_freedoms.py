"""Freedoms of a law that are decided last: damping of the contact, a curve for each direction.

While effects are sought a law must not have them. What passes the filter of a balance holds little
of the damping sigma1, and next to a soft transition curve it is viscous friction for a while after
each reversal; Stribeck curves that differ by direction are an asymmetry. Both would stand in for
what else a model lacks.
"""

from dataclasses import replace

from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, IntegratedShape


def with_last_freedoms(prepared: Prepared, fitted: Fit) -> Fit:
    """The same model with each of these freedoms of its law that leaves clearly less."""
    for free in (IntegratedShape.with_damping, IntegratedShape.by_direction):
        shape = fitted.shape
        if not isinstance(shape, IntegratedShape) or free(shape) == shape:
            continue
        found = refit(prepared, fitted.effects, free(shape))
        if found.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms:
            fitted = _best_form(prepared, found)
    return fitted


def _best_form(prepared: Prepared, fitted: Fit) -> Fit:
    """The same model in the form of its law that leaves least: without a freedom it was another."""
    shape = fitted.shape
    assert isinstance(shape, IntegratedShape)
    others = [replace(shape, form=other.form) for other in INTEGRATED if other.form != shape.form]
    found = [refit(prepared, fitted.effects, other) for other in others]
    return best_of([fitted, *found], lambda f: f.drive_rms)
