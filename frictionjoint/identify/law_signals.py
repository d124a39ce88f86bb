"""Signals of logs with the friction of a law filled in, and the columns that terms make of them."""

from collections.abc import Iterable, Iterator

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, MOTOR, RATE, H, V
from frictionjoint.identify.bundle import Bundle
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term


def full_signals(prepared: Prepared, shape: Shape, Fc: float, sigma2: float) -> list[Array]:
    """Signals of each log with H, RATE and MOTOR filled in for a law."""
    (whole,) = prepared.bundles(1)
    found = list(with_track(whole.tracks.along(shape), whole))
    for signals in found:
        signals[:, MOTOR] = balance(signals, Fc, sigma2)
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


def balance(signals: Array, Fc: float, sigma2: float) -> Array:
    """Torque of the rigid body plus friction, N m, shape (n,).

    Args:
        signals: of the motion, with the hysteresis torque over Fc in column H.
    """
    return np.asarray(signals[:, LOAD] + Fc * signals[:, H] + sigma2 * signals[:, V])
