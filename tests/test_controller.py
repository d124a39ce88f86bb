"""Controllers: their files, their control law, the drive of a log."""

import math
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from frictionjoint.control import PRESETS, Controller, read_controller
from frictionjoint.control import kernel as k
from frictionjoint.control.controller import unknown_notes
from frictionjoint.control.controller_file import controller_of
from frictionjoint.control.kernel_numbers import block_of
from frictionjoint.control.profile import followed_over, held, held_over
from frictionjoint.control.reconstruct import (
    AllCommands,
    check_drive,
    commands,
    difference,
    with_drive,
)
from frictionjoint.errors import LogError, ParameterError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

MODELS = Path(__file__).resolve().parents[1] / "models"
T = np.arange(0.0, 2.0, 0.01)


def log(**more):
    fields = {"target": np.sin(3 * T), "position": 0.9 * np.sin(3 * T - 0.1), **more}
    return JointLog(name="log", joint="j", time=T, **fields)


@pytest.mark.parametrize("preset", PRESETS)
def test_files_keep_every_digit(tmp_path, preset):
    file = tmp_path / "servo.toml"
    file.write_text(PRESETS[preset].to_toml())
    assert read_controller(file) == PRESETS[preset] == read_controller(preset)
    assert PRESETS[preset].source


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("kp = 3.0", "no output"),
        ('output = "duty"\nkp = 3', "a duty needs supply_v"),
        ('output = "volts"\nkp = 3', "output is 'volts': give one of"),
        ('output = "torque_nm"\nkp = -1.0', "kp is -1.0: give 0 or more"),
        ('output = "torque_nm"\nkp = "high"', "kp is 'high': give a number or"),
        ('output = "torque_nm"\nkp = 1\nki = "unknown"', "ki is 'unknown'"),
        ('output = "torque_nm"\nkp = 1\ngain = 2', "unknown 'gain', it has"),
        ('output = "torque_nm"\nkp = true', "kp is True: give a number"),
        ('output = "torque_nm"\nkp = nan', "kp is nan: give a number"),
        ('output = "torque_nm"\nkp = 1\nsupply_v = 3', "supply_v does not go with"),
        ('output = "torque_nm"\nkp = "unknown"\nkd = 2', "kd is 2 together with an unknown kp"),
        ("output = ", "not TOML"),
    ],
)
def test_a_bad_file_is_one_line(tmp_path, text, message):
    file = tmp_path / "servo.toml"
    file.write_text(text)
    with pytest.raises(ParameterError) as found:
        read_controller(file)
    assert message in str(found.value)
    assert "servo.toml" in str(found.value)
    assert "\n" not in str(found.value)


ARM = mujoco.MjModel.from_xml_string("""
<mujoco><worldbody><body><joint name="shoulder"/><geom size="0.1"/>
<body pos="0 0 0.3"><joint name="elbow"/><geom size="0.1"/></body></body></worldbody></mujoco>""")
PER_JOINT = """output = "torque_nm"
kp = 80.0
kd = 2.5
[joint.elbow]
kp = 120.0
"""


def test_a_file_says_what_differs_by_joint(tmp_path):
    file = tmp_path / "arm.toml"
    file.write_text(PER_JOINT)
    shoulder = Controller(output="torque_nm", kp=80.0, kd=2.5)
    elbow = Controller(output="torque_nm", kp=120.0, kd=2.5)
    assert controller_of(file, "shoulder", [ARM]) == read_controller(file) == shoulder
    assert controller_of(file, "elbow", [ARM]) == elbow
    assert controller_of({"elbow": elbow}, "elbow", [ARM]) == elbow
    assert controller_of(shoulder, "elbow", [ARM]) == shoulder
    assert controller_of("mit", "elbow", [ARM]) == PRESETS["mit"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (PER_JOINT + "[joint.wrist]\nkp = 1.0", "no joint 'wrist' in the model, it has elbow, sh"),
        (PER_JOINT + "gain = 1.0", r"\[joint.elbow\]: unknown 'gain', it has"),
        (PER_JOINT.replace("120.0", "-1.0"), r"\[joint.elbow\]: kp is -1.0: give 0 or more"),
        (PER_JOINT.split("[joint")[0] + "joint = 1", r"joint is 1: give tables \[joint.NAME"),
        (PER_JOINT.replace("kp = 80.0", ""), "no kp: a controller needs output and kp"),
        ({"elbow": PRESETS["mit"]}, "controller: none for joint 'shoulder', there is elbow"),
    ],
)
def test_bad_controllers_of_joints_are_one_line(tmp_path, given, message):
    if isinstance(given, str):
        (tmp_path / "arm.toml").write_text(given)
        given = tmp_path / "arm.toml"
    with pytest.raises(ParameterError, match=message) as found:
        controller_of(given, "shoulder", [ARM])
    assert "\n" not in str(found.value)


def test_a_missing_file_names_the_presets(tmp_path):
    with pytest.raises(ParameterError, match="xl330, sts3215"):
        read_controller(tmp_path / "none.toml")


def test_the_drive_is_the_control_law():
    given = log(metadata={"kp": 4.0}, velocity=np.cos(T))
    c = Controller(output="torque_nm", kp="log:kp", kd=0.5, gain_unit=2.0, limit=0.6)
    u = 8.0 * (given.target - given.position) - 1.0 * np.cos(T)
    np.testing.assert_allclose(with_drive(given, c).torque, np.clip(u, -0.6, 0.6), atol=1e-14)


def test_a_duty_is_a_voltage_of_the_log_s_own_supply():
    supply = 12.0 - 0.5 * T
    c = Controller(output="duty", kp=0.7, supply_v=11.0, limit=0.1)
    drive = with_drive(log(supply=supply), c).voltage
    given = log()
    duty = np.clip(0.7 * (given.target - given.position), -0.1, 0.1)
    np.testing.assert_allclose(drive, duty * supply, rtol=1e-12)


def test_an_unknown_gain_leaves_the_error_as_a_current():
    given = with_drive(log(), Controller(output="torque_nm", kp="unknown", limit=2.0))
    assert given.torque is None
    np.testing.assert_allclose(given.current, given.target - given.position, atol=1e-14)


def test_a_damping_that_is_not_known_is_taken_as_none_and_that_is_said():
    known = Controller(output="torque_nm", kp=4.0)
    unknown = replace(known, kd="unknown")
    given = log(velocity=np.cos(T))
    np.testing.assert_array_equal(
        with_drive(given, unknown).torque, with_drive(given, known).torque
    )
    (note,) = unknown_notes(unknown)
    assert "kd is unknown and assumed to be 0" in note
    assert unknown_notes(known) == ()


def drive_of(given, c):
    return commands(given, c).drive()


def test_deadbands_protections_and_counts():
    given = log(target=np.linspace(-1, 1, len(T)), position=np.linspace(0.001, 0.002, len(T)))
    e = given.target - given.position
    plain = {"output": "torque_nm", "kp": 2.0}
    cut = drive_of(given, Controller(**plain, deadband=0.3))
    np.testing.assert_allclose(cut, np.where(np.abs(e) > 0.3, 2 * e, 0.0), atol=1e-14)
    shifted = drive_of(given, Controller(**plain, deadband=0.3, deadband_form="shifted"))
    np.testing.assert_allclose(shifted, 2 * np.sign(e) * np.maximum(np.abs(e) - 0.3, 0), atol=1e-14)
    drop = drive_of(given, Controller(**plain, limit=1.0, drop_above=0.8, drop_left=0.25))
    whole = np.clip(2 * e, -1, 1)
    np.testing.assert_allclose(drop, np.where(np.abs(e) > 0.8, 0.25 * whole, whole), atol=1e-14)
    counted = drive_of(given, Controller(**plain, count_rad=0.1))
    np.testing.assert_allclose(counted, 2 * given.target, atol=1e-14)


def test_a_band_that_cuts_is_silent_whatever_the_velocity():
    given = log(target=np.linspace(-1, 1, len(T)), position=np.zeros(len(T)))
    given = replace(given, velocity=np.full(len(T), 5.0))
    braked = Controller(output="torque_nm", kp=2.0, kd=1.0)
    plain, cut = (drive_of(given, replace(braked, deadband=d)) for d in (0.0, 0.3))
    within = np.abs(given.target) <= 0.3
    assert np.all(plain[within] < -4.0)
    np.testing.assert_array_equal(cut, np.where(within, 0.0, plain))


def test_a_tick_holds_and_a_target_arrives_late():
    given = log()
    plain = {"output": "torque_nm", "kp": 1.0}
    slow = drive_of(given, Controller(**plain, rate_hz=10.0))
    assert np.all(slow.reshape(-1, 10) == slow[::10, None])
    late = drive_of(given, Controller(**plain, delay_s=0.03))
    np.testing.assert_allclose(late[3:], given.target[:-3] - given.position[3:], atol=1e-14)
    np.testing.assert_allclose(held(T, T, np.array([0.004, 0.01, 5.0])), [0.0, 0.01, T[-1]])


@pytest.mark.parametrize("delay", [0.0, 0.012, 0.02, 0.047])
def test_a_mean_command_knows_delays_finer_than_a_sample(delay):
    given = log(position=np.zeros(len(T)))
    c = Controller(output="torque_nm", kp=1.0, delay_s=delay)
    # stairs, averaged over the width of one, are straight lines between their middles
    expected = np.interp(T - delay, T + 0.005, given.target)
    inner = slice(8, -2)
    np.testing.assert_allclose(commands(given, c).mean_drive()[inner], expected[inner], atol=1e-12)
    at_once = commands(given, Controller(output="torque_nm", kp=1.0)).mean_drive(delay=delay)
    np.testing.assert_array_equal(at_once, commands(given, c).mean_drive())


@pytest.mark.parametrize(("delay", "rate"), [(0.0, 1.3), (0.012, 1.3), (0.0, 0.2), (0.02, 40.0)])
def test_a_mean_command_is_followed_at_a_limited_speed_between_samples(delay, rate):
    target = 0.3 * np.sign(np.sin(9.0 * T)) + 0.2 * np.sin(5.0 * T)
    given = log(target=target, position=np.zeros(len(T)))
    # as firmware at 100 kHz follows it, averaged over a sample
    h = 1e-5
    fine = np.arange(T[0] - 0.1, T[-1] + 0.1, h)
    command, follows = held(T, target, fine - delay), np.empty(len(fine))
    here = target[0]
    for i, wanted in enumerate(command):
        here += min(rate * h, max(-rate * h, wanted - here))
        follows[i] = here
    area = np.concatenate([[0.0], np.cumsum(follows) * h])
    edges = np.interp(
        np.concatenate([T - 0.005, T[-1:] + 0.005]), np.append(fine, fine[-1] + h), area
    )
    c = Controller(output="torque_nm", kp=1.0, delay_s=delay, target_rate=rate)
    drive = commands(given, c).mean_drive()
    np.testing.assert_allclose(drive, np.diff(edges) / 0.01, atol=2e-4)


def test_a_target_of_any_speed_is_the_command_itself():
    begin = T - 0.004
    found = [followed_over(T, np.sin(7.0 * T), begin, 0.01, rate) for rate in (1e9, math.inf)]
    np.testing.assert_allclose(found[0], found[1], atol=1e-6)
    np.testing.assert_array_equal(found[1], held_over(T, np.sin(7.0 * T), begin, 0.01))


def test_a_limited_target_rate_makes_a_ramp_of_a_step():
    given = log(target=np.where(T > 0.5, 1.0, 0.0), position=1e-3 * np.sin(T))
    drive = drive_of(given, Controller(output="torque_nm", kp=1.0, target_rate=2.0))
    begin = T[np.argmax(T > 0.5)]
    ramp = np.clip(2.0 * (T - begin), 0.0, 1.0)
    np.testing.assert_allclose(drive + given.position, ramp, atol=1e-9)


def test_a_drive_and_its_mean_follow_one_limited_target():
    """A drive at samples and its mean around them follow one and the same target."""
    target = np.where(np.floor(T / 0.3) % 2 == 1, 0.8, -0.1)
    given = log(target=target, position=np.zeros(len(T)))
    c = Controller(output="torque_nm", kp=1.0, target_rate=3.0, delay_s=0.017)
    seen = commands(given, c)
    there = followed_over(T, target, T - 0.017 - 5e-7, 1e-6, 3.0)
    np.testing.assert_allclose(seen.drive(), there, atol=5e-6)
    assert np.max(np.abs(seen.drive() - seen.mean_drive())) < 0.5 * 3.0 * 0.01


def test_the_drives_of_several_logs_are_those_of_each():
    """Each with its own gain, limit and delay, and what its controller remembers."""
    c = Controller(output="torque_nm", kp="log:kp", ki=2.0, limit=1.0, target_rate=3.0)
    some = [
        commands(log(target=np.sin((2 + j) * T), metadata={"kp": 0.5 + j}), c) for j in range(3)
    ]
    delays = np.array([0.0, 0.013, 0.2])
    blocks = np.array([one.block for one in some])
    blocks[2, k.SLEW] = math.inf
    together = AllCommands(some).mean_drive(blocks, delays)
    alone = [x.mean_drive(b, d) for x, b, d in zip(some, blocks, delays.tolist(), strict=True)]
    np.testing.assert_array_equal(together, np.concatenate(alone))


def test_an_integral_does_not_wind_up():
    given = log(target=np.full(len(T), 5.0), position=0.01 * T)
    c = Controller(output="torque_nm", kp=0.1, ki=1.0, limit=1.0)
    S = np.zeros(k.STATE)
    B = block_of(c, given)
    for t in T:
        k.one_tick(B, S, t, 5.0, 0.0, 0.0)
    assert S[k.INTEGRAL] <= 1.0
    assert k.one_tick(B, S, 2.0, 0.0, 0.0, 0.0) <= 1.0


@pytest.mark.parametrize("value", ["log:kp", "log:nothing"])
def test_a_log_without_the_figure_says_what_it_has(value):
    with pytest.raises(LogError, match="has no figure"):
        commands(log(metadata={"mass": 1.0}), Controller(output="torque_nm", kp=value))


def test_a_log_without_drive_or_controller_says_what_is_missing():
    with pytest.raises(LogError, match="give the gains that drove the joint, --controller"):
        with_drive(log(), None)


def test_a_wrong_controller_is_noticed():
    c = Controller(output="torque_nm", kp=2.0)
    right = with_drive(log(), c)
    assert "agrees" in check_drive(right, c)[0]
    with pytest.raises(LogError, match="off the measured one"):
        check_drive(right, Controller(output="torque_nm", kp=3.0))


def test_the_xl330_drive_agrees_with_its_register(measured_data):
    """To half a per cent in the median of the logs, to 0.8% in each, where the joint is slow."""
    apart = []
    for file in sorted((measured_data / "xl330").glob("*.json")):
        given = read_log(file)
        made = drive_of(given, PRESETS["xl330"])
        slow = np.abs(given.velocity) < 0.5
        on = given.torque_enabled & slow & (np.abs(made) > 0.2)
        apart.append(np.median(np.abs(given.voltage - made)[on] / np.abs(made)[on]))
    assert np.median(apart) < 0.005
    assert max(apart) < 0.008


def test_unlimited_is_written_as_nothing():
    assert "limit" not in Controller(output="torque_nm", kp=1.0, limit=math.inf).to_toml()


def test_the_controller_of_emps_agrees_with_its_log(measured_data):
    """To 0.4% in the median; with the velocity that its loop forms from tick to tick."""
    given = read_log(measured_data / "emps" / "DATA_EMPS.mat")
    known = read_controller(MODELS / "emps.controller.toml")
    assert difference(given, known) < 0.004


@pytest.mark.parametrize(
    ("known", "edge", "below", "above"),
    [
        ({}, 1.0, 8.0, 8.0),
        ({"ki": 3.0}, 1.0, 8.0, 8.0),
        ({"count_rad": 1e-3}, 1.0, 8.0, 8.0),
        ({"limit": 0.8}, 0.1, 8.0, 0.0),
        ({"deadband": 0.1}, 0.1, 0.0, 8.0),
        ({"drop_above": 0.1, "drop_left": 0.25}, 0.1, 8.0, 2.0),
    ],
)
def test_how_a_drive_answers_a_small_error_of_the_position(known, edge, below, above):
    c = Controller(output="torque_nm", kp=8.0, **known)
    seen = commands(log(target=np.sin(3 * T), position=0.8 * np.sin(3 * T)), c)
    found = AllCommands([seen]).answer(seen.block[None], np.zeros(1))
    e = np.abs(seen.target - seen.position)
    # around a sample both are on either side of an edge: the target moves by 0.03
    far = np.abs(e - edge) > 0.045
    np.testing.assert_allclose(found[far], np.where(e < edge, below, above)[far], 1e-6, 1e-9)
