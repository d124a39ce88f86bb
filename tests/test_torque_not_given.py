"""Torque that a drive did not give, that a sensor did not tell, that a model does not explain."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.outcome import _without_unnamed
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.search import refit
from frictionjoint.identify.smooth import ExcessTerm, MissingTerm
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, Q, T, V, logged

LIMIT = 1.5
# as where no law has been fitted alone: each starts from where it is
LAWS = SimpleNamespace(starts=lambda shape: (shape,))


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


@pytest.mark.parametrize(("away", "shows"), [(0.03, True), (0.0, False)])
def test_a_hard_end_of_the_range_takes_torque_at_one_place(tmp_path, away, shows):
    asked = 4.0 * LIMIT * (np.abs((Q.max() - Q) / np.ptp(Q) - away) < 0.01)
    prepared = logged(tmp_path, INERTIA * A + asked)
    level = ExcessTerm("torque", 2.0 * LIMIT, (LIMIT, 3.0 * LIMIT))
    assert level.shows(prepared.segments, prepared.band.motion) == shows


def test_a_sensor_at_the_end_of_its_range_is_told_and_left_out(tmp_path):
    """All of the torque acted; above a level the log holds that level."""
    acted = INERTIA * A + 0.5 * np.clip(V / 0.02, -1.0, 1.0)
    noise = np.random.default_rng(5).normal(0.0, 0.005, len(T))
    prepared = logged(tmp_path, np.minimum(acted + noise, LIMIT))
    base = fit(prepared)
    terms = [c.term for c in library(prepared, base, make_blocks(prepared, base))]
    assert MissingTerm("torque") in terms
    found = refit(prepared, (MissingTerm("torque"),), base.shape)
    size = -found.term_coefficients(0)[0]
    assert size == pytest.approx(np.mean(acted[acted > LIMIT] - LIMIT), rel=0.2)
    state = SimpleNamespace(prepared=prepared, fit=found, laws=LAWS)
    _without_unnamed(state, lambda logs, fitted: None)
    assert not state.fit.effects
    assert state.fit.coefficient("Fc") == pytest.approx(0.5, rel=0.02)
    assert state.fit.rms < 0.2 * base.rms
    # logs held out are prepared as those that were fitted
    held_out = logged(tmp_path, np.clip(acted, -5.0, LIMIT), Q, state.prepared.band)
    for log in (state.prepared, held_out):
        (segment,) = log.segments
        cut = segment.saturated > 0.0
        assert 0.02 < cut.mean() < 0.4
        assert not segment.mask[cut].any()
