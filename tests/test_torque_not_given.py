"""Torque that a drive did not give, and torque that a model only does not explain."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.outcome import _without_unnamed
from frictionjoint.identify.instruments import ExcessTerm
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, T, V, logged

LIMIT = 1.5


@pytest.mark.parametrize("saturates", [True, False], ids=["saturates", "friction varies"])
def test_what_the_torque_says_of_itself_is_no_torque_that_was_not_given(tmp_path, saturates):
    """A residual is a part of the measured torque: it grows with it whatever the model lacks."""
    prepared = prepared_log(tmp_path, saturates)
    base = fit(prepared)
    found = library(prepared, base, make_blocks(prepared, base))
    assert any(isinstance(c.term, ExcessTerm) for c in found) == saturates


def prepared_log(tmp_path, saturates):
    rng = np.random.default_rng(11)
    side, wander = np.clip(V / 0.02, -1.0, 1.0), np.sin(2 * np.pi * 0.11 * T)
    torque = INERTIA * A + 0.5 * side
    if saturates:  # a controller in trouble asks for more than there is, now and then
        beyond = np.abs(torque) > LIMIT
        asked = torque + np.sign(torque) * beyond * np.maximum(wander, 0.0)
    else:
        asked = torque + 0.4 * side * wander
    return logged(tmp_path, asked + rng.normal(0.0, 0.005, len(T)))


@pytest.mark.parametrize("nearer", [True, False, None], ids=["nearer", "no nearer", "not known"])
def test_torque_did_not_act_where_the_motion_comes_nearer_without_it(tmp_path, nearer):
    """What it explains of the balance is a part of itself."""
    prepared = prepared_log(tmp_path, saturates=True)
    shape = fit(prepared).shape
    state = SimpleNamespace(
        prepared=prepared,
        fit=refit(prepared, (ExcessTerm("torque", LIMIT, (0.5 * LIMIT, 1.5 * LIMIT)),), shape),
    )
    drive = prepared.segments[0].drive

    def replayed(logs, fitted):
        asked = np.array_equal(logs.segments[0].drive, drive)
        return None if nearer is None else np.full(8, 1.0 if asked else 0.25 if nearer else 0.95)

    said = _without_unnamed(state, replayed)
    believed = nearer is not False
    assert bool(said) == believed
    assert not state.fit.effects
    now = state.prepared.segments[0].drive
    changed = np.flatnonzero(now != drive)
    assert bool(changed.size) == believed
    assert np.all(np.abs(now[changed]) < np.abs(drive[changed]))
