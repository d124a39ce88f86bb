"""A log ready to be simulated: what its controller is told at every step."""

from dataclasses import replace

import numpy as np
import pytest
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint.control.kernel import STATE, tick
from frictionjoint.control.kernel import TICK as TICK_AT
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm, TargetTiming
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import closed_loop, courses_of, found_controller

MOTOR = (EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf")),)


@pytest.mark.parametrize("rate", [60.0, 300.0, 800.0, 1000.0, 1500.0, 2000.0])
def test_ticks_come_at_their_rate(rate):
    """A step of a millisecond would make 500 Hz of 800."""
    time = 0.01 * np.arange(101)
    log = JointLog(
        name="log", joint="j", time=time, position=0.0 * time, target=time, metadata={"kp": 2.0}
    )
    known = replace(KNOWN, rate_hz=rate)
    run = courses_of([log], [RigidBody(PLANT.format(""), "j")], known)[0].run
    assert 0.5e-3 < run.step <= 1e-3
    S, ticks = np.zeros(STATE), set()
    for i in range(len(run.target)):
        tick(run.block, S, i * run.step, run.target[i], 0.0, 0.0, 1.0)
        ticks.add(S[TICK_AT])
    assert len(ticks) == pytest.approx(min(rate, 1.0 / run.step) + 1.0, abs=1.0)


def test_a_target_that_acts_within_a_sample_does_so_by_the_controller_that_is_written():
    body = RigidBody(PLANT.format(""), "j")
    logs = [servo(f"{m.__name__} 3", 3.0, m, {"delay": 0.006}, 3.0) for m in (steps, sines, swept)]
    law = replace(INTEGRATED[0], Vs=0.1, length=0.002)
    fitted = refit(prepare(logs, body, controller=KNOWN), MOTOR, law)
    found = found_controller(KNOWN, fitted, scaled=True)
    assert found.delay_s == pytest.approx(0.006, abs=0.002)
    bodies = [body] * len(logs)
    (told,) = (t for t in fitted.terms if isinstance(t, TargetTiming))
    others = replace(fitted, terms=tuple(t for t in fitted.terms if t is not told))
    near = closed_loop(courses_of(logs, bodies, found), others)
    assert near.mae == pytest.approx(closed_loop(courses_of(logs, bodies, KNOWN), fitted).mae)
    assert near.mae < 0.2 * closed_loop(courses_of(logs, bodies, KNOWN), others).mae
