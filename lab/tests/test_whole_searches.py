"""Whole searches on simulated joints and arms that take ten seconds and more each."""

import json
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from arms.arm import (
    geared,
    heavier_link_and_rotor,
    hide_coupling,
    hide_mass,
    hide_payload,
    hide_rotor,
    hide_supply,
    random_arm,
)
from limited_and_late import CONTROLLER as LATE_CONTROLLER
from limited_and_late import LATE, LIMIT, MISSING, recorded
from limited_and_late import MODEL as LATE_MODEL
from make_plants import write_plant
from plants.spec import Effect
from round_trip_drive import DRIVES, drive_trip
from round_trip_joint import joint_trip
from servo_plant import KNOWN, KT, PLANT, servo, sines, steps, swept
from trial_logs import PENDULUM
from trials import joint_of

from frictionjoint import close_loop
from frictionjoint.diagnose.close_loop import explain
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import law_alone
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.free_runs import motor_of, simulated_whole
from tests import test_joint_limits as at_limit
from tests import test_motor_temperature as warm
from tests.leg import BELIEVED, CONTROLLER, MODEL, leg
from tests.test_search import named_by_its_quantity, traced
from tests.test_shared_causes import found_in, values
from tests.test_wrong_mass import joint as lone_joint
from tests.test_wrong_mass import told

HIDDEN = {"threshold": 0.3752, "left": 0.3888}
FRICTION = 'frictionloss="0.0479" damping="0.0165"'


def test_two_simple_causes_are_not_one_rich_one():
    arm = random_arm(26, 2)
    hide_mass(arm, "link2", 1.5)
    hide_rotor(arm, "j1")
    found = {name: (place, v) for name, place, v in values(found_in(arm))}
    assert set(found) == {"body-inertia", "rotor-inertia"}
    place, link = found["body-inertia"]
    assert place == {"body": "link2"}
    assert link["mass"] == pytest.approx(arm.hidden["body-inertia"][1], rel=0.1)
    rotor = arm.hidden["rotor-inertia"]["j1"]
    assert found["rotor-inertia"][1]["added"] == pytest.approx(rotor, rel=0.1)


def test_a_cause_that_others_replace_beyond_their_bounds_alone_stays():
    """To first order the link's ten numbers do for the rotor; a possible link does not."""
    arm = heavier_link_and_rotor(88)
    found = {name: v for name, _, v in values(found_in(arm))}
    assert set(found) == {"body-inertia", "rotor-inertia"}
    rotor = arm.hidden["rotor-inertia"]["j1"]
    assert found["rotor-inertia"]["added"] == pytest.approx(rotor, rel=0.05)


def test_a_payload_has_its_mass_beside_a_gain_of_all_drives():
    """Neither holds a part of the other once both are seen."""
    arm = random_arm(415900170, 3)
    hide_payload(arm, 1.2, [0.02, -0.02, 0.03])
    hide_supply(arm, -0.12)
    found = found_in(arm)
    ((name, place, payload),) = values(found)
    assert (name, place) == ("payload", {"body": "link3"})
    assert payload["mass"] == pytest.approx(1.2, rel=0.02)
    ((common, _),) = found.common
    assert common.parameters["gain"].value == pytest.approx(-0.12, rel=0.05)


def test_a_model_without_any_rotor_gets_all_of_them_and_links_stay_near_their_own_mass():
    """As any URDF: one body of six times its mass stood in for two rotors."""
    arm = random_arm(104, 3)
    geared(arm, (1.0, 0.8, 0.6))
    for joint in arm.joints:
        hide_rotor(arm, joint)
    hide_mass(arm, "link2", 1.5, (0.01, -0.01, 0.01))
    shown = found_in(arm)
    found = values(shown)
    for cause, choice in zip(shown.found.causes, shown.choices, strict=True):
        if cause.name == "rotor-inertia":
            assert choice.candidate.joints == (cause.place["joint"],)
    rotors = {place["joint"]: v["added"] for name, place, v in found if name == "rotor-inertia"}
    assert rotors == pytest.approx(arm.hidden["rotor-inertia"], rel=0.1)
    ((body, mass),) = [(p["body"], v["mass"]) for name, p, v in found if name == "body-inertia"]
    assert body == "link2"
    assert mass == pytest.approx(arm.hidden["body-inertia"][1], rel=0.05)


def test_a_heavier_link_is_told_with_the_gain_that_does_the_same():
    """The armature is known, so two numbers are wrong whichever they are."""
    mass, inertia = told(lone_joint(mass=1.25))
    assert mass == {"gravity-error", "torque-gain"}
    assert inertia == {"inertia-error", "torque-gain"}


def test_logs_whose_load_a_delay_hides_are_simulated_all_the_same():
    """A delay hides the load from the law alone; the final model finds the gain all the same."""
    friction = 'frictionloss="0.1417" damping="0.0948"'
    hidden = {"delay": 0.032}
    fit, kept = (
        [
            servo(f"{m.__name__} {kp}", kp, m, hidden, friction=friction)
            for kp in kps
            for m in motion
        ]
        for kps, motion in (((0.6, 1.7), (steps, swept)), ((1.0,), (sines,)))
    )
    bodies = Bodies(PLANT.format(""), "j", None)
    found = explain(fit, kept, bodies, controller=KNOWN, refine=False)
    report = found.report
    assert found.trace.final.gain == pytest.approx(KT, rel=0.05)
    assert report.closed_loops is not None
    before, after = (loops.mae.held_out for loops in report.closed_loops)
    assert after < 0.1 * before


def test_a_threshold_is_found_among_its_samples_with_an_error_that_they_allow(tmp_path):
    """The error of a jacobian knows no samples, each of which is looked at in four parts."""
    trip = drive_trip("duty-drop", tmp_path)
    for found in (trip.first["threshold"], trip.second["threshold"]):
        assert abs(found.value - DRIVES["duty-drop"]["threshold"]) < 0.0015
        assert 0.00025 < found.stderr < 0.005
    assert max(trip.errors.values()) < 2.0, trip.errors


def test_what_the_model_lacks_is_named_and_no_drive_that_does_not_act():
    heavier = prepare([leg(10.0 * BELIEVED, 8)], RigidBody(MODEL, "j"), controller=CONTROLLER)
    found = trace(heavier)
    assert not {f.term.name for f in found.findings} & {effect.name for effect in DRIVE_EFFECTS}


def test_a_gap_comes_back_with_its_flanks(tmp_path):
    trip = joint_trip("backlash", tmp_path, 16.0)
    numbers = {"gap_times_inertia", "flank_resonance", "damping_ratio", "rotor_inertia"}
    assert set(trip.errors) == numbers
    assert max(trip.errors.values()) < 2.0, trip.errors
    gap = trip.first["gap_times_inertia"]
    assert gap.stderr < 0.05 * gap.value
    # the plant's flanks bounce for long, which no log of the motor foretells; the model's do not
    assert trip.left_again < 0.3 * trip.left


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


def test_a_link_with_another_centre_is_not_wrong_in_all_its_ten_parameters():
    arm = random_arm(901, 3)
    hide_mass(arm, "link2", 1.3, [-0.04, 0.01, -0.03])
    ((name, place, found),) = values(found_in(arm))
    assert (name, place) == ("body-inertia", {"body": "link2"})
    assert "Ixx" not in found
    assert found["mass"] == pytest.approx(arm.hidden["body-inertia"][1], rel=0.05)


def test_a_shaft_whose_friction_rises_and_falls_with_the_motors_turn_has_its_wave():
    arm = random_arm(25, 2)
    hide_coupling(arm, 0.005, 0.4, 20.0)
    ((name, place, shaft),) = values(found_in(arm))
    assert (name, place) == ("gear-coupling", {"joint": "j1", "other_joint": "j2"})
    assert shaft["waves"] == pytest.approx(20.0, rel=0.005)
    assert shaft["wave"] == pytest.approx(0.4 * arm.hidden["gear-coupling"][2], rel=0.1)
    assert shaft["level"] == pytest.approx(arm.hidden["gear-coupling"][2], rel=0.1)


def test_a_limit_that_the_model_lacks_is_an_end_stop_and_no_drive_that_saturates():
    true = at_limit.TRUE.replace(
        at_limit.RANGE.format(-at_limit.LIMIT, at_limit.LIMIT), at_limit.RANGE.format(-5.0, 0.4)
    )
    fit, kept = (at_limit.pressed(seed, true) for seed in (1, 3))
    report = close_loop([fit], at_limit.MODEL.format(""), "j", [kept])
    # MuJoCo's limit brakes as well: more may be named beside it, and it begins to act a bit early
    assert report.added[0].effect == "end-stop"
    assert report.added[0].parameters["upper"].value == pytest.approx(0.4, abs=0.02)
    assert not [note for note in report.notes if "saturates" in note]


def test_a_late_torque_beside_a_limit_is_no_gain_with_a_late_target():
    logs = [recorded(0.3)], LATE_MODEL, "j", [recorded(0.15)]
    said = {a.effect: a for a in close_loop(*logs, controller=LATE_CONTROLLER).added}
    assert set(said) == {"inertia-error", "drive-limit", "measurement-delay"}
    sizes = [next(iter(a.parameters.values())).value for a in said.values()]
    wanted = {"inertia-error": MISSING, "drive-limit": LIMIT, "measurement-delay": LATE}
    assert sizes == pytest.approx([wanted[name] for name in said], rel=0.1)


WARM = """<mujoco><option timestep="0.0005" integrator="implicitfast"/>
<worldbody><body><joint name="arm" axis="0 -1 0" armature="0.002" {}/>
<inertial pos="0 0 -0.1" mass="0.5" diaginertia="1e-6 1e-6 1e-6"/></body></worldbody></mujoco>"""


def warm_log(celsius, seed, n=3000):
    """Of a plant of MuJoCo's own with its own friction, at 500 Hz and one temperature."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(WARM.format('frictionloss="0.03" damping="0.01"'))
    data = mujoco.MjData(model)
    time = 2e-3 * np.arange(n)
    volts = sum(
        size * np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.28))
        for size, f in ((3.5, 0.43), (2.5, 1.1), (2.0, 1.9))
    )
    closed, position = time % 4.0 < 3.0, np.empty(n)
    over = 1.0 + warm.A * (celsius - warm.T0)
    for i in range(n):
        position[i] = data.qpos[0]
        for _ in range(4):
            torque = (warm.GAIN * volts[i] - warm.EMF * data.qvel[0]) / over
            data.qfrc_applied[0] = torque if closed[i] else 0.0
            mujoco.mj_step(model, data)
    return JointLog(
        name=f"{celsius} deg C, {seed}",
        joint="arm",
        time=time,
        position=2e-4 * np.round(position / 2e-4),
        voltage=volts + rng.normal(0.0, 0.05, n),
        torque_enabled=closed,
        temperature=np.full(n, celsius) + np.linspace(0.0, 0.5, n),
    )


def test_a_motor_that_gives_less_as_it_warms_is_named_with_its_size():
    body = RigidBody(WARM.format(""), "arm")
    made = [warm_log(t, i) for i, t in enumerate((24.0, 30.0, 36.0, 42.0))]
    found = trace(prepare(made, body), 0)
    assert {"back-emf", "motor-temperature"} <= {step.term.name for step in found.findings}
    at = [term.name for term in found.final.terms].index("motor-temperature")
    term = found.final.terms[at]
    a = float(found.final.term_coefficients(at)[0])
    # both are relative to the gain at the reference
    there = 1.0 + warm.A * (term.shape[0] - warm.T0)
    assert a * there == pytest.approx(warm.A, rel=0.1)
    motor = motor_of(found.final)
    assert motor.gain * there == pytest.approx(warm.GAIN, rel=0.05)
    assert motor.saturation == 0.0
    assert not simulated_whole(found.final, body.armature)
    assert simulated_whole(found.final, body.armature, in_closed_loop=True)


@pytest.mark.parametrize(("seed", "number"), [(40417, 1), (91417, 2), (91417, 3)])
def test_nothing_is_added_to_a_plain_joint_in_slow_motion(seed, number, tmp_path):
    """Its friction is elasto-plastic, of Maxwell slip and of LuGre: the integrated law errs."""
    write_plant(tmp_path, seed, number, "none", slowly=True)
    model = tmp_path / "model.xml"
    logs = [read_log(tmp_path / f"fit{k}.csv", joint_of(model)) for k in (1, 2, 3)]
    assert not trace(prepare(logs, RigidBody(model, joint_of(model)))).findings


def test_friction_at_rest_that_the_encoder_does_not_resolve_spoils_no_law(tmp_path):
    """LuGre, which creeps below a count: a law fitted to its rest has the wrong levels."""
    write_plant(tmp_path, 91417, 3, "none", slowly=True)
    model = tmp_path / "model.xml"
    logs = [read_log(tmp_path / f"fit{k}.csv", joint_of(model)) for k in (1, 2, 3)]
    _, fitted = law_alone(prepare(logs, RigidBody(model, joint_of(model))))
    found = law_parameters(fitted)
    true = json.loads((tmp_path / "answer.json").read_text())["truth"]["friction"]
    assert found.Fs_pos == pytest.approx(true["Fs_pos"], rel=0.1)
    assert found.Fc_pos == pytest.approx(true["Fc_pos"], rel=0.1)


def test_an_eccentric_encoder_is_told_by_the_position(tmp_path):
    wave = Effect("encoder-eccentricity", {"amplitude": 0.03, "phase": 0.5})
    named_by_its_quantity(tmp_path, wave, "position", "off by up to 0.03 rad")


def test_a_drive_that_saturates_is_told_by_the_torque(tmp_path):
    limit = Effect("drive-saturation", {"limit": 2.0})
    found = named_by_its_quantity(tmp_path, limit, "torque", "beyond 2 ")
    # what did not act is taken off the log, and bends no law
    assert found.final.coefficient("Fc") == pytest.approx(PENDULUM.friction.Fc, rel=0.05)
    assert found.final.rms < 0.1 * PENDULUM.friction.Fc


def test_the_law_that_is_asked_for_is_the_result(tmp_path):
    """Whatever law the joint has; the others are compared with it."""
    found = traced(tmp_path, law="static", friction=replace(PENDULUM.friction, law="gms"))
    assert law_parameters(found.base).law == law_parameters(found.final).law == "static"
    assert "static" not in dict(found.other_laws.errors)
    assert "lugre" in dict(found.other_laws.errors)
