"""Refinement by simulation on servos simulated by MuJoCo."""

from dataclasses import replace

import numpy as np
import pytest
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from frictionjoint.refine.refine import refine
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import closed_loop, courses_of

HIDDEN = {"delay": 0.03}
TERMS = (
    EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf")),
    DriveTerm(next(e for e in DRIVE_EFFECTS if e.name == "command-delay"), (0.02,)),
)


@pytest.fixture(scope="module")
def case():
    body = RigidBody(PLANT.format(""), "j")
    seen = [servo(f"{m.__name__} 3", 3.0, m, HIDDEN, 3.0) for m in (steps, sines, swept)]
    unseen = [servo("swept 1", 1.0, swept, HIDDEN, 3.0)]
    prepared = prepare(seen, body, controller=KNOWN)
    fitted = refit(prepared, TERMS, replace(INTEGRATED[0], Vs=0.1, length=0.002), ROUGH)
    cov = np.diag(np.full(fitted.jacobian.shape[1], 1e-4))
    courses = courses_of(seen, [body] * 3, KNOWN)
    other = courses_of(unseen, [body], KNOWN)
    # a balance that is a sixth off in the motor's constant and a third in the delay
    vector = Vector(prepared, fitted, cov, body.armature)
    off = vector.start.copy()
    off[0] += 0.15
    off[-2] *= 0.67
    fitted = vector.fit(off)
    again = vector.fit(off * (1.0 + 1e-13))  # as on another processor
    return fitted, *(refine(prepared, f, courses) for f in (fitted, again)), other


def test_the_last_bits_of_a_fit_are_not_amplified(case):
    _, found, again, _ = case
    assert np.allclose(again.found.values, found.found.values, rtol=1e-9, atol=1e-12)


def test_the_refined_model_moves_nearer_on_another_gain(case):
    fitted, found, _, other = case
    assert found.taken
    assert closed_loop(other, found.fit).mae < 0.8 * closed_loop(other, fitted).mae


def test_what_is_hidden_is_found_again(case):
    _, found, _, _ = case
    delay = next(t for t in found.fit.terms if t.name == "command-delay").shape[0]
    late = sum(t.delay for t in found.fit.terms)
    # a target that acts late and a torque that comes late are alike but for the joint's own motion
    assert delay + late == pytest.approx(HIDDEN["delay"], rel=0.2)
