"""Effects of the drive on servos simulated by MuJoCo, their firmware written here."""

from dataclasses import replace

import numpy as np
import pytest
from servo_plant import KNOWN, PLANT, logs, sines

from frictionjoint.control import Controller
from frictionjoint.control.kernel_numbers import block_of
from frictionjoint.decisions import LEAST_MOVED_OF_DRIVE
from frictionjoint.diagnose.drive import look_at_drive
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import DRIVE_EFFECTS, DRIVE_LIMIT
from frictionjoint.identify.fit import without_scale
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_estimates, scale_note, units_of
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import closed_loop, courses_of, found_controller
from frictionjoint.replay.free_runs import friction_spec

EMF_TERM = EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf"))


def looked(hidden):
    made = logs(hidden)
    body = RigidBody(PLANT.format(""), "j")
    prepared = prepare(made, body, controller=KNOWN)
    speed = max(float(np.abs(np.gradient(log.position, log.time)).max()) for log in made)
    law = replace(INTEGRATED[0], Vs=0.02 * speed, length=2e-3)
    base = refit(prepared, (EMF_TERM,), law, ROUGH)
    return made, body, prepared, base, look_at_drive(prepared, base, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("hidden", "name", "number", "value"),
    [
        ({"delay": 0.03}, "command-delay", 0, 0.03),
        ({"rate": 2.5}, "command-rate", 0, 2.5),
        ({"limit": 0.4}, "drive-limit", 0, 0.4),
        ({"threshold": 0.35, "left": 0.3}, "duty-drop", 1, 0.3),
    ],
    ids=lambda x: x if isinstance(x, str) else None,
)
def test_what_the_firmware_does_is_named_and_measured(hidden, name, number, value):
    made, body, _, base, found = looked(hidden)
    assert found is not None
    term, score = found.tried[0]
    assert term.name == name
    assert term.shape[number] == pytest.approx(value, rel=0.1)
    assert found.look.rows[0].p_value < 0.05
    assert score.of_drive(found.now) > LEAST_MOVED_OF_DRIVE
    # whole logs, simulated from the target alone, come nearer
    courses = courses_of(made, [body] * len(made), KNOWN)
    before, after = (closed_loop(courses, f).mae for f in (base, score.fit))
    assert after < 0.6 * before


def test_a_drive_as_its_file_says_asks_for_nothing():
    _, _, _, _, found = looked({})
    assert found is not None
    _, score = found.tried[0]
    assert score.of_drive(found.now) < LEAST_MOVED_OF_DRIVE


@pytest.mark.parametrize("effect", DRIVE_EFFECTS, ids=lambda e: f"{e.name} {e.form}")
def test_the_controller_found_does_what_the_effect_says(effect):
    time = np.arange(0.0, 1.0, 0.01)
    log = JointLog(
        name="log", joint="j", time=time, position=time, target=time, metadata={"kp": 2.0}
    )
    own = block_of(KNOWN, log)
    shape = tuple(0.2 + 0.1 * i for i in range(len(effect.shape)))
    block, delay = effect.drive(own.copy(), 0.0, shape)

    class Fit:
        terms = (DriveTerm(effect, shape),)
        over_kp = False

    found = found_controller(KNOWN, Fit, scaled=True)
    np.testing.assert_array_equal(block_of(found, log), block)
    assert found.delay_s == delay
    for text in (effect.cause, effect.form, effect.source, effect.signature):
        assert text
    assert effect.separating_motion
    assert len(effect.shape) == len(effect.shape_units) == len(effect.shape_bounds)


def test_a_gain_that_is_not_known_is_found_by_the_load_or_friction_is_over_it():
    time = 0.01 * np.arange(800)
    position = sines(time)
    v = np.gradient(position, time)
    # the plant's inertia and gravity, and its friction
    torque = 0.0281 * np.gradient(v, time) + 1.1772 * np.sin(position)
    torque += 0.03 * v + 0.06 * np.tanh(v / 0.01)
    log = JointLog(
        name="log", joint="j", time=time, position=position, target=position + torque / 3.0
    )
    body = RigidBody(PLANT.format(""), "j")
    unknown = Controller(output="torque_nm", kp="unknown")
    prepared = prepare([log], body, controller=unknown)
    fitted = refit(prepared, (), replace(INTEGRATED[0], Vs=0.1, length=0.002), ROUGH)
    found = found_controller(unknown, fitted, scaled=True)
    assert found.kp == pytest.approx(3.0, rel=0.03)
    assert units_of(fitted, slide=False) == ("N m", "rad")
    assert law_estimates(fitted, np.eye(fitted.jacobian.shape[1]), False)["gain"].unit == "N m/rad"
    spec = body.spec()
    friction_spec(spec, "j", fitted)
    assert not spec.actuators  # its torque goes to the joint, as where kp is known
    # a limit over kp becomes one of the torque
    limit = DriveTerm(DRIVE_LIMIT, (0.5,))
    limited = found_controller(unknown, replace(fitted, terms=(limit,)), scaled=True)
    assert limited.limit == 0.5 * limited.kp
    # and where the load does not tell, nothing is claimed
    assert found_controller(unknown, fitted, scaled=False) == unknown
    over = without_scale(fitted)
    assert units_of(over, slide=False) == ("rad", "rad")
    (note,) = scale_note(over, slide=False)
    assert "over kp, as the position error in rad" in note
    assert "Give kp in the controller's file" in note
