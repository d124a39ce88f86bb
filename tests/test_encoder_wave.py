"""A position that is off by a wave of itself: one amplitude, in all that it changes of a torque."""

import numpy as np
import pytest

from frictionjoint.diagnose.library import library
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.smooth import EncoderTerm
from frictionjoint.identify.starts import fit
from frictionjoint.measured.log import JointLog
from tests.three_sines import sines

MODEL = """<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 0.02"/></body></worldbody></mujoco>"""
LINES = ((0.9, 0.21), (0.4, 0.53), (0.2, 0.93))


def off_by(q, v, a, amplitude, order):
    """The same where the position is less by a wave of itself."""
    angle = order * q
    d = amplitude * np.sin(angle)
    rate = amplitude * order * np.cos(angle)
    return q - d, v - rate * v, a - rate * a + order**2 * d * v**2


def test_its_size_is_told_where_viscous_friction_says_it():
    """Inertia hardly shows: alone, it said 1.8 rad of a measured joint."""
    rng, t = np.random.default_rng(7), np.arange(0.0, 60.0, 5e-3)
    measured = sines(t, LINES)
    _, v, a = off_by(*measured, 0.04, 1.0)
    drive = 0.02 * a + 2.0 * np.clip(v / 0.02, -1.0, 1.0) + 8.0 * v
    drive += 0.05 * rng.standard_normal(len(t))
    log = JointLog(name="log", joint="j", time=t, position=measured[0], torque=drive)
    prepared = prepare([log], RigidBody(MODEL, "j"))
    base = fit(prepared)
    offered = library(prepared, base, make_blocks(prepared, base))
    (wave,) = (c for c in offered if isinstance(c.term, EncoderTerm) and c.term.order == 1.0)
    columns = np.hstack([wave.columns, base.free_jacobian])
    said = np.linalg.lstsq(columns, base.residual, rcond=None)[0]
    assert np.hypot(said[0], said[1]) == pytest.approx(0.04, rel=0.1)
