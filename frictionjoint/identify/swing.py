"""Initial free oscillation of an elastic joint: its link need not be at rest when a log begins."""

import numpy as np
from scipy.linalg import block_diag

from frictionjoint.arrays import Array
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.terms import EffectTerm, Term


def swing_columns(segment: Segment, term: Term) -> tuple[Array, Array]:
    """Torques of an initial free oscillation, per unit of the term's coefficient: columns on the
    kept samples, shape (n, 2), of a deflection and of a rate with the same amplitude; and these
    two, shape (2,)."""
    assert isinstance(term, EffectTerm)
    assert term.effect.free is not None
    sizes = np.array([1.0, 2.0 * np.pi * term.shape[0]])
    signals = term.hung(segment.signals)
    found = [
        term.effect.free(term.shape, (float(d), float(rate)), signals) for d, rate in np.diag(sizes)
    ]
    return segment.balanced(np.column_stack(found)), sizes


def swings_of(prepared: Prepared, term: Term) -> Array:
    """Columns of `swing_columns` for all logs, two per log, shape (n, 2 k)."""

    def made() -> Array:
        return np.asarray(block_diag(*(swing_columns(s, term)[0] for s in prepared.segments)))

    return prepared.columns.get(("swings", term), made)
