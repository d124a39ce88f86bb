"""What a controller does has forms that some logs do not tell apart, and joints resemble it."""

import numpy as np
import pytest
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.diagnose.candidate import without_columns
from frictionjoint.diagnose.exchange import exchange_drive
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.state import State
from frictionjoint.effects.drive import DROP_ABOVE_OUTPUT, DUTY_DROP
from frictionjoint.effects.motor import BACK_EMF
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import DriveTerm, EffectTerm

GAIN = 2.5
BODY = RigidBody(PLANT.format(""), "j")


def state_with(prepared, *terms):
    """A search that has these effects, all found in one look."""
    fitted = fit(prepared, terms)
    rows = [Looked(without_columns(t), np.ones(2), 0.01, 1.0) for t in fitted.effects]
    seen = Look(tuple(rows), 2.0 * np.ones(2), 0.0)
    findings = [
        Finding(t, seen, row, 0.5, (), (), fitted)
        for t, row in zip(fitted.effects, rows, strict=True)
    ]
    laws = OtherLaws(prepared, fitted)
    return State(prepared, fitted, findings, seen, laws, law_errs=False)


def test_of_forms_that_leave_the_same_the_first_is_taken_and_the_other_said():
    """Without damping an output is the error times the gain, and these logs have one gain."""
    hidden = {"threshold": 0.31, "left": 0.35}
    logs = [servo(m.__name__, GAIN, m, hidden) for m in (steps, sines, swept)]
    prepared = prepare(logs, BODY, controller=KNOWN)
    of_output = DriveTerm(DROP_ABOVE_OUTPUT, (0.31 * GAIN, 0.35))
    state = state_with(prepared, EffectTerm(BACK_EMF), of_output)
    rng = np.random.default_rng(0)
    assert exchange_drive(state, rng)
    found = state.findings[1]
    assert found.term.effect is DUTY_DROP
    assert state.fit.effects[1].effect is DUTY_DROP
    assert state.fit.effects[1].shape == pytest.approx((0.31, 0.35), rel=0.05)
    # the other one does not come back, and is told
    assert not exchange_drive(state, rng)
    assert state.findings[1].forms == (DROP_ABOVE_OUTPUT,)
