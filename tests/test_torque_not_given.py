"""Torque that a drive did not give, and torque that a model only does not explain."""

import numpy as np
import pytest

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.library import library
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.measured.log import JointLog

MODEL = """<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 0.05"/></body></worldbody></mujoco>"""
LIMIT = 1.5


@pytest.mark.parametrize("saturates", [True, False], ids=["saturates", "friction varies"])
def test_what_the_torque_says_of_itself_is_no_torque_that_was_not_given(tmp_path, saturates):
    """A residual is a part of the measured torque: it grows with it whatever the model lacks."""
    rng, t = np.random.default_rng(11), np.arange(0.0, 40.0, 2e-3)
    lines = [(0.9, 0.31), (0.5, 0.73), (0.3, 1.31)]
    q, v, a = (
        sum(
            A * (2 * np.pi * f) ** k * np.sin(2 * np.pi * f * t + 0.5 * np.pi * k) for A, f in lines
        )
        for k in range(3)
    )
    side, wander = np.clip(v / 0.02, -1.0, 1.0), np.sin(2 * np.pi * 0.11 * t)
    torque = 0.05 * a + 0.5 * side
    if saturates:  # a controller in trouble asks for more than there is, now and then
        beyond = np.abs(torque) > LIMIT
        asked = torque + np.sign(torque) * beyond * np.maximum(wander, 0.0)
    else:
        asked = torque + 0.4 * side * wander
    file = tmp_path / "j.xml"
    file.write_text(MODEL)
    logged = asked + rng.normal(0.0, 0.005, len(t))
    log = JointLog(name="log", joint="j", time=t, position=q, torque=logged)
    prepared = prepare([log], RigidBody(file, "j"))
    base = fit(prepared)
    found = library(prepared, base, make_blocks(prepared, base))
    assert any(isinstance(c.term, ExcessTerm) for c in found) == saturates
