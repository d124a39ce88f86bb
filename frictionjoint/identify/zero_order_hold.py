"""Whether the drive of a log is constant from one sample to the next.

A controller that ticks with the samples outputs a torque that is constant until the next tick. Then
the acceleration is constant in between, and the spectrum of the samples differs from that of a
smooth motion. With x = half of the angle of a frequency per sample:

    positions      their second derivative is too small by x / tan x
    mean torques   a smooth quantity is smaller by sin x / x over a tick, and half a tick late

To second order that is the torque of an elastic joint with its resonance at 0.78 of the sampling
frequency, and such a joint would be found.
"""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY
from frictionjoint.effects.signals import GX, GY, LOAD, A, Q, V
from frictionjoint.identify.law_basis import plain_friction, top_speed
from frictionjoint.identify.segment import Segment

# delays of the drive that may go with either, in samples
_LATE = np.linspace(-0.5, 2.0, 26)


def of_acceleration(omega: Array, sample: float) -> Array:
    """Ratio of the acceleration of a held torque to the second derivative of the samples."""
    x = _half_angle(omega, sample)
    return np.asarray(np.tan(x) / x)


def of_drive(omega: Array, sample: float) -> Array:
    """Ratio of a torque at the middle of a tick to its mean over the tick."""
    x = _half_angle(omega, sample)
    return np.asarray(x / np.sin(x))


def holds(smooth: Sequence[Segment], held: Sequence[Segment]) -> bool:
    """Whether the drive of logs is constant between samples, as judged by the torque balance of the
    logs prepared without and with the corrections.

    Such a drive is half a sample late, which is easier to detect than its amplitude. It is constant
    if the residual with this delay and the corrections is smaller than the residual without
    corrections at any delay.
    """
    without, left = _left(smooth), _left(held)
    half = abs(_LATE[np.argmin(left)] - 0.5) <= 0.15
    at_once = without[np.argmin(np.abs(_LATE))]
    return bool(half and left.min() < min(without.min(), (1.0 - CLEARLY) * at_once))


def _half_angle(omega: Array, sample: float) -> Array:
    # rad, far beyond any band
    return np.clip(0.5 * sample * omega, 1e-9, 1.4)


def _left(segments: Sequence[Segment]) -> Array:
    """rms residual of the drive in a linear balance, for each delay."""
    top = top_speed(segments)
    rows = [_balanced(s, top) for s in segments]
    X, late = (np.concatenate(x) for x in zip(*rows, strict=True))
    # about 6000 samples suffice
    every = max(1, len(X) // 6000)
    X, late = X[::every], late[::every]
    size = np.linalg.norm(X, axis=0)
    Z = np.linalg.svd(X[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    basis = Z[0][:, Z[1] > 1e-6 * Z[1][0]]
    left = late - basis @ (basis.T @ late)
    return np.asarray(np.sqrt(np.mean(left**2, axis=0)))


def _balanced(s: Segment, top: float) -> tuple[Array, Array]:
    """Columns of a linear balance, shape (m, k), and the drive with each delay, on kept samples."""
    motion = s.signals[:, [LOAD, GX, GY, V, A, Q]]
    columns = [motion, plain_friction(s, top), np.ones(len(motion))]
    late = [s.balanced_drive(delay * s.sample) for delay in _LATE]
    return s.balanced(np.column_stack(columns)), np.column_stack(late)
