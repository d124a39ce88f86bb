"""Share of the inertia behind an elastic joint, which carries all of its gravity.

A model that combines motor and link has one inertia. A rotor is balanced, so gravity acts on the
link alone. At a given resonance the link sags more if its inertia is smaller.
"""

import numpy as np

from frictionjoint.effects.signals import GEAR, inertia_of
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared

# relative change of a share that does not change a fit noticeably
RESOLUTION = 0.05
# range of a share
SHARES = (0.05, 1.0)


def implied_share(prepared: Prepared, fitted: Fit, i: int) -> float:
    """Share that a fit puts behind the spring of term i; all of it if it has a share of none."""
    whole = float(np.median([inertia_of(s.signals, GEAR) for s in prepared.segments]))
    (behind,) = fitted.term_coefficients(i)
    return float(np.clip(behind / whole, *SHARES)) if whole > 0.0 and behind > 0.0 else 1.0
