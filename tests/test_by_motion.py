"""Effects that simulated motion names besides the balance, on servos simulated by MuJoCo."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from law_shapes import law_at
from servo_plant import COUNT, KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.control.kernel import BLOCK
from frictionjoint.control.kernel import COUNT as COUNT_AT
from frictionjoint.diagnose.by_motion import held_out_evidence, is_large, named_by_motion, taken
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.library import Candidate
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.diagnose.sight import Sight
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.refine.vector import with_term
from frictionjoint.replay.closed_loop import closed_loop, courses_of, joint_model

MOTOR = (EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf")),)


def named(friction, armature="0.01", motions=(steps, sines, swept)):
    """What is named where the balance has found the motor alone.

    Returns also the errors on an unseen gain, refined over those of the balance, and the
    refinement.
    """
    body = RigidBody(PLANT.format("").replace('armature="0.01"', f'armature="{armature}"'), "j")
    logs = [
        servo(f"{m.__name__} {kp}", kp, m, {}, 2.0, friction=friction)
        for kp in (0.8, 3.0)
        for m in motions
    ]
    prepared = prepare(logs, body, controller=KNOWN)
    fitted = refit(prepared, MOTOR, law_at(INTEGRATED[0], 0.1, 0.002), ROUGH)
    look = Look((), np.zeros(0), 0.0)
    row = Looked(Candidate(MOTOR[0], np.zeros((0, 0))), np.zeros(0), 0.001, 1.0)
    own = Finding(MOTOR[0], look, row, 1.0, (), (), fitted)
    found = Trace(prepared, fitted, (own,), fitted, (), (), look, None, Sight(0.0, 0.0, 0.0, ()))
    courses = courses_of(logs, [body] * len(logs), KNOWN)
    found, refined = named_by_motion(found, courses, body.armature)
    assert [f.term for f in found.findings] == list(found.final.effects)
    unseen = courses_of([servo("swept 1.5", 1.5, swept, {}, 2.0, friction=friction)], [body], KNOWN)
    errors = [closed_loop(unseen, f).mae for f in (refined.fit, fitted)]
    return found.findings[1:], errors[0] / errors[1], refined


def test_a_spring_that_the_balance_left_out_is_named():
    findings, part, _ = named('frictionloss="0.06" damping="0.03" stiffness="0.6" springref="0.5"')
    assert [f.term.name for f in findings] == ["spring"]
    assert findings[0].gain > 0.3
    assert part < 0.5


def test_nothing_is_named_where_nothing_is_there():
    findings, *_ = named('frictionloss="0.06" damping="0.03"')
    assert not [f.term.name for f in findings]


def test_an_armature_that_is_wrong_in_the_model_is_a_number_of_the_refinement():
    # four logs are too few to name anything else by motion
    friction = 'frictionloss="0.06" damping="0.03"'
    findings, part, refined = named(friction, armature="0.06", motions=(sines, swept))
    found = dict(zip(refined.vector.names, refined.values, strict=True))
    assert not findings
    assert found["inertia-error 0.inertia"] == pytest.approx(0.01 - 0.06, rel=0.1)
    assert part < 0.2


def test_a_motor_is_screened_where_the_balance_has_named_none():
    """With it comes the law's damping, which has a number of its own."""
    logs = [servo("sines 3", 3.0, sines, {}, 3.0)]
    prepared = prepare(logs, RigidBody(PLANT.format(""), "j"), controller=KNOWN)
    law = replace(law_at(INTEGRATED[0], 0.1, 0.002), damped=True)
    fitted = refit(prepared, (), law, ROUGH)
    assert "sigma1" not in fitted.names
    found = with_term(prepared, fitted, MOTOR[0], np.array([0.2]))
    assert "sigma1" in found.names
    assert joint_model(found).back_emf == 0.2
    assert found.levels == fitted.levels


def errors(near, whole=None, fitted=None):
    """A refinement with its errors on logs left out, in windows and whole, and on its own, rad."""
    near = np.array(near)
    whole = near if whole is None else np.array(whole)
    own = near if fitted is None else np.array(fitted)
    return SimpleNamespace(near=near, left_out=(whole, whole), near_fitted=own)


def log_with_a_count():
    block = np.zeros(BLOCK)
    block[COUNT_AT] = COUNT
    return SimpleNamespace(run=SimpleNamespace(block=block))


def test_a_whole_log_that_goes_astray_does_not_keep_an_effect_from_being_named():
    rng = np.random.default_rng(5)
    near = 0.02 * rng.uniform(0.7, 1.3, 12)
    whole = near.copy()
    whole[3] = 0.2  # sticks once too early with the effect, by its numbers without that kind
    now, other = errors(near), errors(0.7 * near, 0.7 * whole)
    seen = held_out_evidence(MOTOR[0], other, now)
    assert seen.gain(seen.rows[0]) == pytest.approx(1.0 - 0.7**2)
    assert seen.rows[0].p_value < 0.05
    assert is_large(other, now, [log_with_a_count()] * 12)
    assert np.sum(other.left_out[1] ** 2) > np.sum(now.left_out[1] ** 2)


def test_what_all_models_lose_without_a_kind_does_not_hide_an_effect():
    """And what is small beside all that is left is not made large by numbers badly known."""
    rng = np.random.default_rng(7)
    fitted = 0.02 * rng.uniform(0.7, 1.3, 12)
    lost = np.where(np.arange(12) % 4 == 0, 0.05, 0.0)
    now, other = (
        errors(fitted + lost, fitted=fitted),
        errors(0.7 * fitted + lost, fitted=0.7 * fitted),
    )
    seen = held_out_evidence(MOTOR[0], other, now)
    assert seen.gain(seen.rows[0]) < 0.3
    assert seen.rows[0].p_value < 0.05
    assert taken(other, now) == pytest.approx((1.0 - 0.7**2) * np.mean(fitted**2))
    assert is_large(other, now, [log_with_a_count()] * 12)
    small = errors(0.7 * fitted, fitted=0.9 * fitted)
    assert not is_large(small, errors(fitted + lost, fitted=fitted), [log_with_a_count()] * 12)


def test_what_is_less_than_a_count_of_the_encoder_is_no_effect():
    near = COUNT * np.array([1.0, 1.2, 0.9, 0.7, 0.6, 1.5])
    courses = [log_with_a_count()] * 6
    assert not is_large(errors(0.65 * near), errors(near), courses)
    assert is_large(errors(6.5 * near), errors(10.0 * near), courses)
