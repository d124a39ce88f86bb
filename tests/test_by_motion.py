"""Effects that simulated motion names besides the balance, on servos simulated by MuJoCo."""

from dataclasses import replace

import numpy as np
import pytest
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.diagnose.by_motion import named_by_motion
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.detection_limit import DetectionLimit
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.position import POSITION_PERIODIC as WAVE
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.replay.closed_loop import closed_loop, courses_of

MOTOR = (EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf")),)


def named(friction, armature="0.01", motions=(steps, sines, swept), balance=MOTOR, hidden=None):
    """What is named besides what the balance has found, at first the motor alone.

    Returns also the errors on an unseen gain, refined over those of the balance, and the
    refinement.
    """
    body = RigidBody(PLANT.format("").replace('armature="0.01"', f'armature="{armature}"'), "j")
    logs = [
        servo(f"{m.__name__} {kp}", kp, m, hidden or {}, 2.0, friction=friction)
        for kp in (0.8, 3.0)
        for m in motions
    ]
    prepared = prepare(logs, body, controller=KNOWN)
    fitted = refit(prepared, balance, replace(INTEGRATED[0], Vs=0.1, length=0.002), ROUGH)
    look = Look((), np.zeros(0), 0.0)
    row = Looked(Candidate(MOTOR[0], np.zeros((0, 0))), np.zeros(0), 0.001, 1.0)
    own = tuple(Finding(term, look, row, 1.0, (), (), fitted) for term in balance)
    found = Trace(
        prepared, fitted, own, fitted, (), (), look, None, DetectionLimit(0.0, 0.0, 0.0, ())
    )
    courses = courses_of(logs, [body] * len(logs), KNOWN)
    found, refined = named_by_motion(found, courses, body.armature)
    assert [f.term for f in found.findings] == list(found.final.effects)
    other = servo("swept 1.5", 1.5, swept, hidden or {}, 2.0, friction=friction)
    unseen = courses_of([other], [body], KNOWN)
    errors = [closed_loop(unseen, f).mae for f in (refined.fit, fitted)]
    return found.findings[len(balance) :], errors[0] / errors[1], refined


def test_a_spring_that_the_balance_left_out_is_named():
    findings, part, _ = named('frictionloss="0.06" damping="0.03" stiffness="0.6" springref="0.5"')
    assert [f.term.name for f in findings] == ["spring"]
    assert findings[0].gain > 0.3
    assert part < 0.5


def test_a_second_wave_is_named_beside_a_first():
    first = EffectTerm(WAVE, (7.0,))
    friction, waves = 'frictionloss="0.06" damping="0.03"', {7: 0.15, 12: 0.1}
    findings, part, _ = named(friction, balance=(*MOTOR, first), hidden={"waves": waves})
    (second,) = (f.term for f in findings)
    assert second.name == "position-periodic"
    assert second.shape[0] == pytest.approx(12.0, rel=0.02)
    assert part < 0.5


def test_nothing_is_named_where_nothing_is_there():
    findings, *_ = named('frictionloss="0.06" damping="0.03"')
    assert not [f.term.name for f in findings]


def test_an_armature_that_is_wrong_in_the_model_is_a_number_of_the_refinement():
    # four logs are too few to name anything else by motion
    friction = 'frictionloss="0.06" damping="0.03"'
    findings, part, refined = named(friction, armature="0.06", motions=(sines, swept))
    found = dict(zip(refined.found.vector.names, refined.found.values, strict=True))
    assert not findings
    assert found["inertia-error 0.inertia"] == pytest.approx(0.01 - 0.06, rel=0.1)
    assert part < 0.2
