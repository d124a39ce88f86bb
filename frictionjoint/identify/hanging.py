"""Share of the inertia behind an elastic joint, which carries all of its gravity."""

from dataclasses import replace

import numpy as np

from frictionjoint.effects.inertia import inertia_of
from frictionjoint.effects.signals import GEAR
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm, Term

# least part of an inertia, and relative change of a part that moves nothing
_LEAST, _ALIKE = 0.05, 0.05


def hanging(prepared: Prepared, fitted: Fit) -> tuple[Term, ...]:
    """The terms of a fit, each with the share of the inertia that the fit puts behind its spring.

    A model that combines motor and link has one inertia. A rotor is balanced, so gravity acts on
    the link alone. At a given resonance the link sags more if its inertia is smaller.
    """
    return tuple(_hung(prepared, fitted, i) for i in range(len(fitted.terms)))


def _hung(prepared: Prepared, fitted: Fit, i: int) -> Term:
    term = fitted.terms[i]
    if not isinstance(term, EffectTerm) or not term.effect.of_inertia:
        return term
    whole = float(np.median([inertia_of(s.signals, GEAR) for s in prepared.segments]))
    (behind,) = fitted.term_coefficients(i)
    part = float(np.clip(behind / whole, _LEAST, 1.0)) if whole > 0.0 and behind > 0.0 else 1.0
    return term if abs(part - term.part) <= _ALIKE * term.part else replace(term, part=part)
