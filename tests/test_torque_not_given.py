"""Torque that a drive did not give, and torque that a model only does not explain."""

import numpy as np
import pytest

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.library import library
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, T, V, logged

LIMIT = 1.5


@pytest.mark.parametrize("saturates", [True, False], ids=["saturates", "friction varies"])
def test_what_the_torque_says_of_itself_is_no_torque_that_was_not_given(tmp_path, saturates):
    """A residual is a part of the measured torque: it grows with it whatever the model lacks."""
    rng = np.random.default_rng(11)
    side, wander = np.clip(V / 0.02, -1.0, 1.0), np.sin(2 * np.pi * 0.11 * T)
    torque = INERTIA * A + 0.5 * side
    if saturates:  # a controller in trouble asks for more than there is, now and then
        beyond = np.abs(torque) > LIMIT
        asked = torque + np.sign(torque) * beyond * np.maximum(wander, 0.0)
    else:
        asked = torque + 0.4 * side * wander
    prepared = logged(tmp_path, asked + rng.normal(0.0, 0.005, len(T)))
    base = fit(prepared)
    found = library(prepared, base, make_blocks(prepared, base))
    assert any(isinstance(c.term, ExcessTerm) for c in found) == saturates
