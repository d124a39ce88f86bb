"""Signals of logs with the friction of a law filled in, and the columns that terms make of them."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, MOTOR, RATE, H, V
from frictionjoint.identify.bundle import Bundle
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term


def full_signals(prepared: Prepared, shape: Shape, Fc: float, sigma2: float) -> list[Array]:
    """Signals of each log with H, RATE and MOTOR, the rigid body's torque plus friction, N m."""
    found = list(with_track(prepared.whole.tracks.along(shape), prepared.whole))
    for signals in found:
        signals[:, MOTOR] = signals[:, LOAD] + Fc * signals[:, H] + sigma2 * signals[:, V]
    return found


def with_track(track: Array, bundle: Bundle) -> Iterator[Array]:
    """Signals of each log with H and RATE of a law, shape (2, n), filled in."""
    for segment, own in zip(bundle.logs, bundle.places, strict=True):
        signals = segment.signals.copy()
        signals[:, H], signals[:, RATE] = track[:, own]
        yield signals


def columns_of_term(term: Term, signals: Iterable[Array], part: Bundle) -> Array:
    """Columns of a term along each log of a bundle, on the kept samples, (m, k)."""
    logs = zip(part.logs, signals, strict=True)
    return part.kept(np.concatenate([term.columns(s, x) for s, x in logs]).T)


def with_motor(X: Array, beta: Array, layout: Layout, segments: Sequence[Segment]) -> Array:
    """The columns, including those that depend on the motor torque, in a fit to voltage or current.

    The motor torque equals the rest of the balance, without what acts on the motor. So it follows
    from the unknown coefficients: these columns and the coefficients are computed alternately. It
    is filtered, because the motion is known no finer, and unfiltered steps of friction would stand
    out.

    Args:
        X: shape (n, k), rows of the logs' kept samples; the first column is that of the load.
        beta: in units of the drive, shape (k,).
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
        signals = segment.at_kept(segment.signals)
        end = begin + len(signals)
        signals[:, MOTOR] = torque[begin:end]
        for i in at:
            filled[begin:end, layout.coefficients(i)] = layout.terms[i].columns(segment, signals)
        begin = end
    return np.asarray(filled)
