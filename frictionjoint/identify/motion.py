"""The filtered motion of a log, the rigid-body torque along it, and whether the drive is held.

A controller that ticks with the samples outputs a torque that is constant until the next tick. Then
the acceleration is constant in between, and the spectrum of the samples differs from that of a
smooth motion. With x = half of the angle of a frequency per sample:

    positions      their second derivative is too small by x / tan x
    mean torques   a smooth quantity is smaller by sin x / x over a tick, and half a tick late

To second order that is the torque of an elastic joint with its resonance at 0.78 of the sampling
frequency, and such a joint would be found.
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY
from frictionjoint.effects.signals import GX, GY, LOAD, A, Q, V
from frictionjoint.identify.law_basis import plain_friction, top_speed
from frictionjoint.identify.rigid_body import RigidBody, RigidBodyTorque
from frictionjoint.identify.segment import Segment
from frictionjoint.measured.derivatives import HIGHEST, on_a_grid, uniform_motion
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, steep

# delays of the drive, in samples, at which a held drive is looked for
_LATE = np.linspace(-0.5, 2.0, 26)


class Motion(NamedTuple):
    """A log's motion on a uniform grid, rad and s, or m and s, shape (n,) each."""

    raw_time: Array  # the log's own grid, shape (m,)
    raw: Array  # position on it
    sample: float  # its sampling interval, s
    smooth: LowPass  # from the log's grid to this one
    time: Array
    dt: float  # time step, s
    q: Array
    v: Array
    a: Array
    others: dict[str, tuple[Array, Array, Array]]  # q, v and a of other joints by name
    rigid: RigidBodyTorque
    gear: Array  # rigid-body torque without the armature's part


def grid_steps(corner_hz: float) -> tuple[float, float]:
    """Shortest and longest step of a grid for a motion of some corner, s."""
    # laws are driven along steps of the grid, and a reversal between two samples is blurred
    longest = 2.5e-3
    # samples per period of the motion's corner
    return min(longest, 1.0 / (2.5 * corner_hz)), longest


def motion_of(log: JointLog, body: RigidBody, corner_hz: float, held: bool) -> Motion:
    """Filter a log's motion and compute inverse dynamics; if the drive is held constant between
    samples, the acceleration accounts for it."""
    raw_time, raw, sample = on_a_grid(log)
    finest, longest = grid_steps(corner_hz)
    # a slow log is not refined at any cost
    step, up = max(1, int(finest / sample)), min(16, -int(-sample // longest))
    corner = min(corner_hz, HIGHEST / sample)
    smooth = LowPass(len(raw_time), sample, corner, steep, step, up)
    dt = sample * step / up
    time = raw_time[0] + dt * np.arange(smooth.given)
    more = partial(of_acceleration, sample=sample) if held else None
    q, v, a = smooth.motion(raw, more)
    others = {
        name: smooth.motion(uniform_motion(log.time, position, raw_time), more)
        for name, position in log.other_positions.items()
    }
    named = {name: triple for name, triple in others.items() if name in body.joint_names}
    rigid = body.torque(q, v, a, named)
    gear = rigid.load - body.armature * a
    return Motion(raw_time, raw, sample, smooth, time, dt, q, v, a, others, rigid, gear)


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
