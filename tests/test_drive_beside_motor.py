"""A drive that is far off hides the motor's back-EMF: both are found together."""

import pytest
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody

HIDDEN = {"threshold": 0.3752, "left": 0.3888}
FRICTION = 'frictionloss="0.0479" damping="0.0165"'


def test_a_protection_is_not_taken_for_a_limit():
    body = RigidBody(PLANT.format(""), "j")
    logs = [
        servo(f"{m.__name__} {kp}", kp, m, HIDDEN, friction=FRICTION)
        for kp in (1.7, 5.0)
        for m in (steps, sines, swept)
    ]
    found = trace(prepare(logs, body, controller=KNOWN), 0)
    terms = {term.name: term for term in found.final.effects}
    assert {"back-emf", "duty-drop"} <= set(terms)
    assert "drive-limit" not in terms
    threshold, left = terms["duty-drop"].shape
    assert threshold == pytest.approx(HIDDEN["threshold"], rel=0.1)
    assert left == pytest.approx(HIDDEN["left"], rel=0.1)
