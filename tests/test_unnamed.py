"""Directions of dependences without a name that a score leaves out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose import outcome
from frictionjoint.diagnose.candidate import without_columns
from frictionjoint.diagnose.score import Scored
from frictionjoint.identify.instruments import MissingTerm
from frictionjoint.identify.search import refit
from frictionjoint.identify.smooth import SplineTerm
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, Q, T, V, logged


def test_they_are_those_of_the_samples_that_are_left(tmp_path):
    """Without samples at a sensor's limit a direction had another length, and was forgotten."""
    friction = np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0)
    torque = INERTIA * A + friction + 0.3 * Q**3
    torque += 0.05 * np.random.default_rng(2).standard_normal(len(T))
    before = logged(tmp_path, torque)
    limit = np.where(np.abs(before.segments[0].drive) > 1.5, 1.0, 0.0)
    before = replace(before, segments=(replace(before.segments[0], saturated=limit),))
    terms = SplineTerm("position", -1.7, 1.7), MissingTerm("torque")
    found = refit(before, terms, fit(before).shape)
    now = before.without_limits()
    assert 0 < len(now.log_index) < len(before.log_index)
    (whole,) = outcome._unnamed_torque(before, found, before)
    (left,) = outcome._unnamed_torque(before, found, now)
    assert left.shape == (len(now.log_index), 1)
    still = now.segments[0].kept[before.segments[0].kept]
    np.testing.assert_array_equal(left, whole[still])


@pytest.mark.parametrize(("its", "tied"), [(0.05, False), (0.31, True)])
def test_a_quantity_that_explains_much_less_is_no_tie(monkeypatch, its, tied):
    """One block carries the difference, which is no more than its own standard error."""
    time, velocity = SplineTerm("time", 0.0, 1.0), SplineTerm("velocity", -1.0, 1.0)
    fit = SimpleNamespace(effects=(time,), shape=None)
    shares = {(): 0.0, (time,): 0.33, (velocity,): its}

    def scored(found, blocks):
        squares = np.ones(100)
        squares[0] += 100.0 - 200.0 * shares[found.effects]
        return Scored(found, squares)

    monkeypatch.setattr(outcome, "scored", scored)
    monkeypatch.setattr(outcome, "best_first", lambda state, blocks, i, others: others)
    monkeypatch.setattr(
        outcome, "compared", lambda prepared, terms, law: SimpleNamespace(effects=terms)
    )
    state = SimpleNamespace(fit=fit, prepared=None, candidates=[without_columns(velocity)])
    assert list(outcome.quantities_alike(state, None, 0)) == ["velocity"] * tied
