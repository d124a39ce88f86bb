"""The presliding damping sigma1, which is decided last.

The torque band contains little of it. With a soft transition curve it acts like viscous friction
after each reversal and imitates whatever else the model lacks; with hardly any friction level this
makes the search discontinuous. So the integrated law is fitted without it first.
"""

from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared


def with_damping(prepared: Prepared, fitted: Fit) -> Fit:
    """The same model with presliding damping if that clearly reduces the residual."""
    damped = fitted.shape.with_damping()
    if damped is None:
        return fitted
    found = refit(prepared, fitted.effects, damped)
    return found if found.drive_rms < (1.0 - CLEARLY) * fitted.drive_rms else fitted
