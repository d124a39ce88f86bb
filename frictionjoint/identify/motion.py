"""The filtered motion of a log, and the rigid-body torque along it."""

from functools import partial
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.rigid_body import RigidBody, RigidBodyTorque
from frictionjoint.identify.zero_order_hold import of_acceleration
from frictionjoint.measured.derivatives import HIGHEST, on_a_grid, uniform_motion
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, steep


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
