"""Directions of dependences without a name that a score leaves out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose import outcome
from frictionjoint.diagnose.candidate import without_columns
from frictionjoint.diagnose.score import Scored
from frictionjoint.effects.rigid_body import SPRING
from frictionjoint.identify.search import refit
from frictionjoint.identify.smooth import MissingTerm, SplineTerm
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from tests.three_sines import INERTIA, A, Q, T, V, logged


def test_they_are_those_of_the_samples_that_are_left_without_what_effects_explain(tmp_path):
    """Directions were forgotten for their length, or took the evidence of effects next to them."""
    torque = INERTIA * A + np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0) + 0.3 * Q**3
    torque += 0.05 * np.random.default_rng(2).standard_normal(len(T))
    before = logged(tmp_path, torque)
    log, past = before.segments[0], 1.0 * (np.abs(before.segments[0].drive) > 1.5)
    before = replace(before, segments=(replace(log, saturated=past),))
    terms = EffectTerm(SPRING), SplineTerm("position", -1.7, 1.7), MissingTerm("torque")
    found, now = refit(before, terms, fit(before).shape), before.without_limits()
    named = refit(now, terms[:1], found.shape)
    (left,) = outcome._unnamed_torque(before, found, now, named)
    assert left.shape == (len(now.log_index), 1) < (len(before.log_index), 1)
    stiffness, direction, residual = (
        x[:, 0] * named.weight / np.linalg.norm(x[:, 0] * named.weight)
        for x in (named.jacobian[:, named.layout.coefficients(0)], left, named.residual[:, None])
    )
    assert abs(direction @ stiffness) < 1e-9 < 0.7 < direction @ residual


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
