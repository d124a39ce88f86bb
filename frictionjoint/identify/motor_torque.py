"""The motor torque in a fit to voltage or current.

It equals the rest of the balance, so it follows from the unknown coefficients: the columns that
depend on it and the coefficients are computed alternately.
"""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import MOTOR
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.segment import Segment


def with_motor(X: Array, beta: Array, layout: Layout, segments: Sequence[Segment]) -> Array:
    """The columns, including those that depend on the motor torque.

    The torque is the whole balance except what acts on the motor. It is filtered, because the
    motion is known no finer, and unfiltered steps of friction would stand out.

    Args:
        X: columns in the order of the layout, shape (n, k), the first that of the load.
        beta: coefficients in units of the drive, shape (k,).
        segments: the logs whose kept samples are the rows.
    """
    at = [i for i, term in enumerate(layout.terms) if MOTOR in term.effect.needs]
    if not at:
        return X
    taken = beta.copy()
    for i, term in enumerate(layout.terms):
        if term.effect.on_motor:
            taken[layout.coefficients(i)] = 0.0
    torque = X @ taken / beta[0]
    filled, begin = X.copy(), 0
    for segment in segments:
        signals = segment.kept_signals.copy()
        end = begin + len(signals)
        signals[:, MOTOR] = torque[begin:end]
        for i in at:
            filled[begin:end, layout.coefficients(i)] = layout.terms[i].columns(segment, signals)
        begin = end
    return np.asarray(filled)
