"""A log ready to be simulated: what its controller is told at every step."""

from dataclasses import replace

import numpy as np
import pytest
from law_shapes import law_at
from servo_plant import COUNT, KNOWN, PLANT, PLANT_STEP, TICK, moved, servo, sines, steps, swept

from frictionjoint.control.kernel import KP, STATE, one_tick
from frictionjoint.control.kernel import TICK as TICK_AT
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.timing import TargetTiming
from frictionjoint.measured.first_velocity import first_velocity
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import closed_loop, courses_of, found_controller

MOTOR = (EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf")),)


@pytest.fixture(scope="module")
def course():
    time = 0.01 * np.arange(100)
    log = JointLog(
        name="steps",
        joint="j",
        time=time,
        position=0.1 * np.sin(time),
        target=np.floor(time / 0.1 + 1e-9),
        metadata={"kp": 2.0},
        motion="stairs",
    )
    return courses_of([log], [RigidBody(PLANT.format(""), "j")], KNOWN)[0]


def later(course, delay):
    return course.changed([lambda block, before: (block, before + delay)]).target


def test_a_command_holds_until_the_next_one(course):
    steps = course.run.step * np.arange(len(course.run.target))
    np.testing.assert_allclose(course.run.target, np.floor(steps / 0.1 + 1e-6), atol=1e-6)
    ten = round(0.01 / course.run.step)
    np.testing.assert_allclose(later(course, 0.01)[ten:], course.run.target[:-ten], atol=1e-6)


def test_a_delay_finer_than_a_step_acts_for_its_part_of_it(course):
    h = course.run.step
    for delay in (0.2 * h, 3.7 * h):
        # every step up comes later by the delay, and none is lost: the area tells
        lost = h * np.sum(course.run.target - later(course, delay))
        assert lost == pytest.approx(delay * course.target[-1], rel=1e-6)


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
        one_tick(run.block, S, i * run.step, run.target[i], 0.0, 0.0)
        ticks.add(S[TICK_AT])
    assert len(ticks) == pytest.approx(min(rate, 1.0 / run.step) + 1.0, abs=1.0)


def test_a_delay_that_is_found_acts_smoothly_between_ticks():
    time = 0.01 * np.arange(101)
    stairs = np.floor(time / 0.1 + 1e-9)
    log = JointLog(
        name="log", joint="j", time=time, position=0.0 * time, target=stairs, metadata={"kp": 2.0}
    )
    known = replace(KNOWN, rate_hz=200.0)
    course = courses_of([log], [RigidBody(PLANT.format(""), "j")], known)[0]

    def at_ticks(delay):
        return later(course, delay)[:: round(0.005 / course.run.step)]

    for delay in (0.0101, 0.0127, 0.0149):
        assert np.any(at_ticks(delay + 1e-4) != at_ticks(delay))
    # as given it is exact
    np.testing.assert_allclose(course.run.target, np.round(course.run.target), atol=1e-9)


def test_what_tells_logs_of_one_kind_comes_along(course):
    assert course.figures == {"kp": 2.0, "motion": "stairs", "load": 0.0}
    changed = course.changed([lambda block, delay: (np.full_like(block, 0.5), delay)])
    assert changed.block[KP] == 0.5
    assert course.run.block[KP] == 2.0


@pytest.mark.parametrize("motion", [steps, sines, swept])
def test_a_plant_run_again_from_its_log_does_as_it_did(motion):
    """The log holds the target that the plant followed, and its beginning the velocity."""
    hidden = {"delay": 0.02}
    log = servo("again", 3.0, motion, hidden)
    course = courses_of([log], [RigidBody(PLANT.format(""), "j")], KNOWN)[0]
    friction = 'frictionloss="0.06" damping="0.03"'
    exact = moved(log.target, 3.0, hidden, friction)
    assert np.max(np.abs(exact - log.position)) <= 0.5 * COUNT + 1e-12
    again = moved(log.target, 3.0, hidden, friction, course.run.start)
    assert np.mean(np.abs(again - log.position)) < 0.5 * COUNT


@pytest.mark.parametrize("motion", [steps, sines, swept])
def test_a_plant_is_no_integrators_own(motion):
    """In steps half as long it moves as it did, to a tenth of a count."""
    command = motion(0.01 * np.arange(300))
    friction = 'frictionloss="0.06" damping="0.03"'
    plain, finer = (moved(command, 3.0, {}, friction, step=h) for h in (PLANT_STEP, PLANT_STEP / 2))
    assert np.mean(np.abs(plain - finer)) < 0.1 * COUNT
    coarse = moved(command, 3.0, {}, friction, step=TICK)
    assert np.mean(np.abs(coarse - finer)) > 0.1 * COUNT


@pytest.mark.parametrize("motion", [steps, sines, swept])
@pytest.mark.parametrize("emf", [0.0, 0.9])
def test_simulations_in_windows_start_from_the_motion_of_the_joint(motion, emf):
    """To less than a count, also where steps set off a joint that little brakes."""
    hidden = {"emf": emf}
    log = servo("log", 1.0, motion, hidden)
    course = courses_of([log], [RigidBody(PLANT.format(""), "j")], KNOWN)[0]
    position, velocity = course.motion
    exact = moved(log.target, 1.0, hidden, 'frictionloss="0.06" damping="0.03"')
    off = course.at_samples(position) - exact
    assert np.sqrt(np.mean(off**2)) < COUNT
    speed = np.gradient(exact, log.time)
    off = course.at_samples(velocity) - speed
    assert np.sqrt(np.mean(off**2)) < 0.05 * np.std(speed)


@pytest.mark.parametrize("count", [0.0, COUNT])
def test_a_joint_that_is_sent_off_from_rest_begins_at_rest(count):
    t = 0.01 * np.arange(60)
    sent = 1.2 * (1.0 - (1.0 + t / 0.05) * np.exp(-t / 0.05))  # up to 9 rad/s within 0.05 s
    position = np.round(sent / count) * count if count else sent
    assert abs(first_velocity(t, position, count)) < 1.0
    assert abs(np.gradient(position, t)[0]) > 2.0


@pytest.mark.parametrize("velocity", [-2.0, 0.3])
def test_a_joint_that_moves_already_begins_so(velocity):
    t = 0.005 * np.arange(100)
    position = np.round((0.2 + velocity * t - 0.5 * t**2) / COUNT) * COUNT
    assert first_velocity(t, position, COUNT) == pytest.approx(velocity, abs=0.1)


def test_a_target_that_acts_within_a_sample_does_so_by_the_controller_that_is_written():
    body = RigidBody(PLANT.format(""), "j")
    logs = [servo(f"{m.__name__} 3", 3.0, m, {"delay": 0.006}, 3.0) for m in (steps, sines, swept)]
    fitted = refit(prepare(logs, body, controller=KNOWN), MOTOR, law_at(INTEGRATED[0], 0.1, 0.002))
    found = found_controller(KNOWN, fitted, scaled=True)
    assert found.delay_s == pytest.approx(0.006, abs=0.002)
    bodies = [body] * len(logs)
    (told,) = (t for t in fitted.terms if isinstance(t, TargetTiming))
    others = replace(fitted, terms=tuple(t for t in fitted.terms if t is not told))
    near = closed_loop(courses_of(logs, bodies, found), others)
    assert near.mae == pytest.approx(closed_loop(courses_of(logs, bodies, KNOWN), fitted).mae)
    assert near.mae < 0.2 * closed_loop(courses_of(logs, bodies, KNOWN), others).mae
