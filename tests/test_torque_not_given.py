"""Torque that a drive did not give, that a sensor did not tell, that a model does not explain."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.outcome import _without_unnamed
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.instruments import ExcessTerm, MissingTerm, as_given
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, Q, T, V, logged

LIMIT = 1.5
# as where no law has been fitted alone: each starts from where it is
LAWS = SimpleNamespace(starts=lambda shape: (shape,))


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


@pytest.mark.parametrize(
    ("fraction", "text"), [(0.72, "72% failed"), (0.96, "all of it"), (1.1, "all of it")]
)
def test_no_more_than_all_is_missing(fraction, text):
    term = ExcessTerm("torque", 14.0, (10.0, 20.0))
    assert term.says(np.array([fraction]), "N m").startswith(
        f"Of the torque logged beyond 14 N m, {text}"
    )


@pytest.mark.parametrize("nearer", [True, False, None], ids=["nearer", "no nearer", "not known"])
def test_torque_did_not_act_where_the_motion_comes_nearer_without_it(tmp_path, nearer):
    """What it explains of the balance is a part of itself."""
    prepared = prepared_log(tmp_path, saturates=True)
    shape = fit(prepared).shape
    state = SimpleNamespace(
        prepared=prepared,
        fit=refit(prepared, (ExcessTerm("torque", LIMIT, (0.5 * LIMIT, 1.5 * LIMIT)),), shape),
        laws=LAWS,
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
    # of logs held out the same did not act
    assert np.array_equal(as_given(prepared, said).segments[0].drive, now)


def with_noise(torque):
    return torque + np.random.default_rng(5).normal(0.0, 0.005, len(T))


def missing(prepared):
    """Torque that acted beside what was logged at the end of the range, mean, N m, and the fit."""
    shape = fit(prepared).shape
    found = refit(prepared, (MissingTerm("torque"),), shape)
    return -found.term_coefficients(0)[0], found


def test_a_sensor_at_the_end_of_its_range_is_told_and_left_out(tmp_path):
    """All of the torque acted; above a level the log holds that level."""
    acted = INERTIA * A + 0.5 * np.clip(V / 0.02, -1.0, 1.0)
    prepared = logged(tmp_path, np.clip(with_noise(acted), -np.inf, LIMIT))
    base = fit(prepared)
    terms = [c.term for c in library(prepared, base, make_blocks(prepared, base))]
    assert MissingTerm("torque") in terms
    size, found = missing(prepared)
    assert size == pytest.approx(np.mean(acted[acted > LIMIT] - LIMIT), rel=0.2)
    state = SimpleNamespace(prepared=prepared, fit=found, laws=LAWS)
    _without_unnamed(state, lambda logs, fitted: None)
    assert not state.fit.effects
    assert state.fit.coefficient("Fc") == pytest.approx(0.5, rel=0.02)
    assert state.fit.rms < 0.2 * base.rms
    # logs held out are prepared as those that were fitted
    for log in (
        state.prepared,
        logged(tmp_path, np.clip(acted, -5.0, LIMIT), Q, state.prepared.band),
    ):
        (segment,) = log.segments
        cut = segment.saturated > 0.0
        assert 0.02 < cut.mean() < 0.4
        assert not segment.mask[cut].any()


def test_a_drive_at_its_limit_that_acts_is_missing_nothing(tmp_path):
    """The motion is that of the torque as logged."""
    h, q, v, rows = 5e-4, 0.0, 0.0, []
    for k in range(80_000):
        target = 0.6 * np.sin(2 * np.pi * 0.31 * k * h) + 0.15 * np.sin(2 * np.pi * 1.3 * k * h)
        torque = float(np.clip(8.0 * (target - q) - 0.8 * v, -1.0, 1.0))
        v += h / INERTIA * (torque - 0.5 * np.tanh(v / 0.02))
        q += h * v
        rows.append((q, torque))
    position, torque = np.array(rows)[::4].T
    prepared = logged(tmp_path, torque, position)
    assert prepared.segments[0].saturated is not None
    size, _ = missing(prepared)
    assert size < 0.01
