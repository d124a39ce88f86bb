"""Freedoms of a law that are decided last: damping of the contact, a curve for each direction.

While effects are sought a law must not have them. What passes the filter of a balance holds little
of the damping sigma1, and next to a soft transition curve it is viscous friction for a while after
each reversal; Stribeck curves that differ by direction are an asymmetry. Both would stand in for
what else a model lacks.
"""

from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import IntegratedShape


def with_last_freedoms(prepared: Prepared, fitted: Fit) -> Fit:
    """The same model with each of these freedoms of its law that leaves clearly less."""
    shape = fitted.shape
    if not isinstance(shape, IntegratedShape):
        return fitted
    for free in (IntegratedShape.with_damping, IntegratedShape.by_direction):
        freed = free(shape)
        if freed == shape:
            continue
        found = refit(prepared, fitted.effects, freed)
        if found.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms:
            fitted, shape = found, freed.moved(found.shape.vector())
    return fitted
