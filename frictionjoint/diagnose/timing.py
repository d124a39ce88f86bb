"""When in a sample the torque of a log belongs to its motion.

A controller holds its torque from one tick to the next, and the log has the torque of the tick: on
average it acts half a period later. Channels read one after the other differ by as much. Too little
to be an effect, it turns inertia J into a viscosity, J w^2 T at the frequency w, and so moves what
a fit says of that.
"""

from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.intervals import stated_covariance
from frictionjoint.identify.fit import Fit, fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.terms import Timing, delay_of

# share of a sample within which the delay must stay to be one of sampling
_WITHIN = 0.98
# standard errors beyond which it is none of chance
_BEYOND = 2.0


class Delay(NamedTuple):
    """Time by which the position is logged later than the torque, and its standard error, s."""

    value: float
    stderr: float


def timed(prepared: Prepared, fitted: Fit) -> Fit:
    """A fit with the delay between torque and position free within a sample.

    Returns:
        `fitted` itself where it has a delay, where the logs show none beyond chance, or one of a
        sample or more: that is the effect `measurement-delay`.
    """
    if delay_of(fitted.terms) != 0.0:
        return fitted
    term = Timing(min(s.dt for s in prepared.segments))
    found = fit(prepared, (*fitted.terms, term), start=fitted.shape)
    delay = timing_of(found, stated_covariance(prepared, found))
    told = delay and _BEYOND * delay.stderr < abs(delay.value) < _WITHIN * term.most
    return found if told else fitted


def timing_of(fitted: Fit, cov: Array) -> Delay | None:
    """The delay within a sample that a fit has, if it has one.

    Args:
        cov: of all parameters of the fit, in the order of its jacobian.
    """
    if not fitted.terms or not isinstance(fitted.terms[-1], Timing):
        return None
    return Delay(fitted.terms[-1].shape[0], float(np.sqrt(cov[-1, -1])))
