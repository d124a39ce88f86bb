"""Logs of a joint that reaches the limits of its MJCF: what a limit gives no log tells."""

import numpy as np
import pytest
from test_constraint_law import driven

from frictionjoint import close_loop
from frictionjoint.diagnose.library import other_forms
from frictionjoint.effects.position import BOTH_STOPS, LOWER_STOP, UPPER_STOP
from frictionjoint.identify.matching import check_logs
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog

LOSS, LIMIT = 0.3, 0.55
MODEL = """
<mujoco><compiler angle="radian"/><worldbody><body>
<joint name="j" axis="0 1 0" armature="0.02" {}/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="4e-3 4e-3 1e-3"/>
</body></worldbody><actuator><motor joint="j"/></actuator></mujoco>"""
RANGE = 'range="{} {}" limited="true"'
BELIEVED = MODEL.format(RANGE.format(-LIMIT, LIMIT))
TRUE = MODEL.format(RANGE.format(-LIMIT, LIMIT) + f' damping="0.2" frictionloss="{LOSS}"')


def pressed(seed: int, true: str = TRUE) -> JointLog:
    """The joint led along sines that go beyond its range, its torque logged."""
    return driven(seed, 0.02, true, 10.0, (0.5, 0.2, 0.08), (0.35, 1.3, 3.1), (25.0, 0.8))


def swinging(reach: float) -> JointLog:
    t = np.arange(0.0, 10.0, 0.005)
    q = reach * np.sin(3.0 * t)
    return JointLog(name="log", joint="j", time=t, position=q, torque=np.zeros_like(t))


def test_torque_against_a_limit_is_neither_friction_nor_a_drive_that_saturates():
    report = close_loop([pressed(1)], BELIEVED, "j", [pressed(3)])
    assert not report.added
    assert not report.unexplained
    assert report.final["Fc_pos"].value == pytest.approx(LOSS, rel=0.02)
    (said,) = [note for note in report.notes if "end of its range" in note]
    assert "-0.55 to 0.55 rad" in said
    assert "ignored" in said


def test_limits_at_both_ends_that_the_model_lacks_are_one_end_stop():
    report = close_loop([pressed(1)], MODEL.format(""), "j", [pressed(3)])
    (stop,) = report.added
    assert stop.effect == "end-stop"
    assert stop.parameters["upper"].value == pytest.approx(LIMIT, abs=0.02)
    assert stop.parameters["lower"].value == pytest.approx(-LIMIT, abs=0.02)
    assert not [note for note in report.notes if "saturates" in note]


def test_a_stop_at_one_end_is_tried_where_the_stop_at_both_ends_has_it():
    prepared = prepare([pressed(1)], RigidBody(MODEL.format(""), "j"))
    both = refit(prepared, (EffectTerm(BOTH_STOPS, (0.5, -0.4)),), INTEGRATED[0], ROUGH)
    (stop,) = both.effects
    forms = {c.term.effect: c.term.shape for c in other_forms(prepared, both, stop)}
    assert forms == {UPPER_STOP: stop.shape[:1], LOWER_STOP: stop.shape[1:]}


@pytest.mark.parametrize(
    ("reach", "stands", "said"),
    [
        (0.5, False, None),
        (0.56, True, "ignored"),
        (0.9, False, "It moves up to 0.35 rad beyond, so the range is assumed wrong there."),
    ],
)
def test_a_joint_that_moves_far_beyond_a_limit_does_not_meet_it(reach, stands, said):
    body, log = RigidBody(BELIEVED, "j"), swinging(reach)
    assert body.at_limit(log.position).any() == stands
    notes = [note for note in check_logs([log], body) if "end of its range" in note]
    assert bool(notes) == (said is not None)
    assert all(said in note for note in notes)
