"""The damping of a contact, sigma1, which is decided last.

What passes the filter of a balance holds little of it, and beside a soft transition curve it is
viscous friction for a while after each reversal: it stands in for what else a model lacks, and
where it does so with hardly any level, a search has cliffs in its way. So the integrated law is
sought without it.
"""

from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared


def with_damping(prepared: Prepared, fitted: Fit) -> Fit:
    """The same model with its law damped where it leaves clearly less so."""
    damped = fitted.shape.with_damping()
    if damped is None:
        return fitted
    found = refit(prepared, fitted.effects, damped)
    return found if found.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms else fitted
