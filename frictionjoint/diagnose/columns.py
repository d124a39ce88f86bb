"""Signals of logs under a fit, and the columns of a term on their kept samples."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import MOTOR
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.law_signals import columns_of_term, full_signals
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm, Term


def signals_of(prepared: Prepared, fitted: Fit) -> list[Array]:
    """Signals of each log under the fitted law; the torque of a motor under the whole model."""
    found = full_signals(prepared, fitted.shape, *fitted.levels)
    if not prepared.gain_unknown:
        return found
    for s, signals in zip(prepared.segments, found, strict=True):
        # with all columns made first: a term may look at the torque of the law
        signals[:, MOTOR] += sum(
            [
                term.columns(s, signals) @ fitted.term_coefficients(i)
                for i, term in enumerate(fitted.terms)
                if term.coefficients and not term.effect.on_motor
            ],
            np.zeros(len(signals)),
        )
    return found


def columns_of(prepared: Prepared, signals: list[Array], term: Term) -> Array:
    """Columns of a term on the kept samples of all logs.

    A delay shifts the drive and has no column of its own; its first order is the rate of the drive.
    """
    if not term.coefficients:
        parts = [s.balanced_drive(0.0, 1) for s in prepared.segments]
        return np.concatenate(parts)[:, None]
    (whole,) = prepared.bundles(1)

    def made() -> Array:
        return columns_of_term(term, signals, whole)

    # what no fit changes is looked at again and again
    fixed = isinstance(term, EffectTerm) and not (term.follows_law or term.effect.on_motor)
    if not fixed:
        return made()
    swings = tuple(s.swing for s in prepared.segments)
    return prepared.columns.get(("term", term, swings), made)
