"""Effects of the drive on servos simulated by MuJoCo, their firmware written here."""

import math

import mujoco
import numpy as np
import pytest

from frictionjoint.control import Controller
from frictionjoint.control.block import block_of
from frictionjoint.diagnose.closed_loop import closed_loop, courses_of, found_controller
from frictionjoint.diagnose.drive import LEAST_OF_DRIVE, look_at_drive, of_drive
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.identify.fit import ROUGH, refit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from frictionjoint.measured.log import JointLog

PLANT = """<mujoco><option timestep="0.001" integrator="implicitfast"/><compiler angle="radian"/>
<worldbody><body><joint name="j" axis="0 -1 0" armature="0.01" {}/>
<inertial pos="0 0 -0.15" mass="0.8" diaginertia="1e-4 1e-4 1e-4"/></body></worldbody></mujoco>"""
COUNT = 2 * math.pi / 4096
KT, EMF, SUPPLY = 0.4, 0.9, 12.0
KNOWN = Controller(output="duty", kp="log:kp", supply_v=SUPPLY, limit=1.0, count_rad=COUNT)
EMF_TERM = EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf"))


def steps(t):
    return 0.9 * (np.floor(t / 1.1) % 2) - 0.3


def sines(t):
    return 0.7 * np.sin(2.1 * t) + 0.4 * np.sin(6.3 * t)


def swept(t):
    return 0.8 * np.sin(0.9 * t**2)


def servo(name, kp, target, hidden, duration=5.0):
    """A log at 100 Hz; `hidden` is what its firmware does that no file says."""
    model = mujoco.MjModel.from_xml_string(PLANT.format('frictionloss="0.06" damping="0.03"'))
    data = mujoco.MjData(model)
    n = int(duration * 1000)
    time = 1e-3 * np.arange(n)
    command = target(0.01 * np.floor(time / 0.01))  # sent a hundred times a second
    late = round(1000 * hidden.get("delay", 0.0))
    position, inner = np.empty(n), command[0]
    for i in range(n):
        position[i] = round(data.qpos[0] / COUNT) * COUNT
        wanted = command[max(0, i - late)]
        way = hidden.get("rate", math.inf) * 1e-3
        inner += min(way, max(-way, wanted - inner))
        error = inner - position[i]
        duty = kp * error
        if abs(error) < hidden.get("deadband", 0.0):
            duty = 0.0
        limit = hidden.get("limit", 1.0)
        duty = min(limit, max(-limit, duty))
        if abs(error) > hidden.get("threshold", math.inf):
            duty *= hidden["left"]
        data.qfrc_applied[0] = KT * duty * SUPPLY - EMF * data.qvel[0]
        mujoco.mj_step(model, data)
    some = slice(0, n, 10)
    return JointLog(
        name=name,
        joint="j",
        time=time[some],
        position=position[some],
        target=command[some],
        metadata={"kp": kp},
    )


def logs(hidden):
    motions = (steps, sines, swept)
    return [servo(f"{m.__name__} {kp}", kp, m, hidden) for kp in (0.8, 3.0) for m in motions]


def looked(hidden):
    body = RigidBody(PLANT.format(""), "j")
    made = logs(hidden)
    prepared = prepare(made, body, controller=KNOWN)
    speed = max(float(np.abs(np.gradient(log.position, log.time)).max()) for log in made)
    law = INTEGRATED[0].grid(speed, 2.0)[2]
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
    assert of_drive(score, found.now) > LEAST_OF_DRIVE
    # whole logs, simulated from the target alone, come nearer
    courses = courses_of(made, [body] * len(made), KNOWN)
    before, after = (closed_loop(courses, f).mae for f in (base, score.fit))
    assert after < 0.6 * before


def test_a_drive_as_its_file_says_asks_for_nothing():
    _, _, _, _, found = looked({})
    assert found is not None
    _, score = found.tried[0]
    assert of_drive(score, found.now) < LEAST_OF_DRIVE


def test_a_measured_drive_is_not_looked_at():
    made = logs({})[:1]
    body = RigidBody(PLANT.format(""), "j")
    made = [JointLog(**{**vars(x), "torque": np.sin(3 * x.time)}) for x in made]
    prepared = prepare(made, body, controller=KNOWN)
    base = refit(prepared, (), INTEGRATED[0].grid(5.0, 2.0)[2], ROUGH, 1)
    assert look_at_drive(prepared, base, np.random.default_rng(0)) is None


@pytest.mark.parametrize("effect", DRIVE_EFFECTS, ids=lambda e: f"{e.name} {e.form}")
def test_the_controller_found_does_what_the_effect_says(effect):
    log = logs_of_nothing()
    own = block_of(KNOWN, log)
    shape = tuple(0.2 + 0.1 * i for i in range(len(effect.shape)))
    block, delay = effect.drive(own.copy(), 0.0, shape)

    class Fit:
        terms = (DriveTerm(effect, shape),)

    found = found_controller(KNOWN, Fit)
    np.testing.assert_array_equal(block_of(found, log), block)
    assert found.delay_s == delay
    for text in (effect.cause, effect.form, effect.source, effect.signature):
        assert text
    assert effect.separating_motion
    assert len(effect.shape) == len(effect.shape_units) == len(effect.shape_bounds)


def logs_of_nothing():
    time = np.arange(0.0, 1.0, 0.01)
    return JointLog(
        name="log", joint="j", time=time, position=time, target=time, metadata={"kp": 2.0}
    )
