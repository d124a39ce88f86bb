"""Share of the inertia behind an elastic joint, which carries all of its gravity.

A model that combines motor and link has one inertia. A rotor is balanced, so gravity acts on the
link alone. At a given resonance the link sags more if its inertia is smaller.
"""

import numpy as np

from frictionjoint.effects.signals import GEAR, inertia_of
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm

# relative change of a share that does not change a fit noticeably
RESOLUTION = 0.05


def implied_share(prepared: Prepared, fitted: Fit, i: int) -> float | None:
    """Share that a fit puts behind the spring of term i; None: no spring, or the share assumed."""
    term = fitted.terms[i]
    if not (isinstance(term, EffectTerm) and term.effect.of_inertia):
        return None
    whole = float(np.median([inertia_of(s.signals, GEAR) for s in prepared.segments]))
    (behind,) = fitted.term_coefficients(i)
    share = float(np.clip(behind / whole, 0.05, 1.0)) if whole > 0.0 and behind > 0.0 else 1.0
    return None if abs(share - term.part) <= RESOLUTION * term.part else share
