"""Controllers: their files, their control law, the drive of a log."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from frictionjoint.control import PRESETS, Controller, read_controller
from frictionjoint.control.controller import unknown_notes
from frictionjoint.control.controller_file import controller_of
from frictionjoint.control.profile import held
from frictionjoint.control.reconstruct import check_drive, commands, difference, with_drive
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
        ('output = "torque_nm"\nkp = 1e300', "kp is 1e+300: give at most 1e+09"),
        (
            'output = "torque_nm"\nkp = 1\nrate_hz = 1e9',
            "rate_hz is 1000000000.0: give at most 1e+06",
        ),
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
        (PER_JOINT.replace("kp = 80.0", ""), "no kp: give output"),
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


def test_a_tick_holds_and_a_target_arrives_late():
    given = log()
    plain = {"output": "torque_nm", "kp": 1.0}
    slow = drive_of(given, Controller(**plain, rate_hz=10.0))
    assert np.all(slow.reshape(-1, 10) == slow[::10, None])
    late = drive_of(given, Controller(**plain, delay_s=0.03))
    np.testing.assert_allclose(late[3:], given.target[:-3] - given.position[3:], atol=1e-14)
    np.testing.assert_allclose(held(T, T, np.array([0.004, 0.01, 5.0])), [0.0, 0.01, T[-1]])


def test_a_log_without_drive_or_controller_says_what_is_missing():
    with pytest.raises(LogError, match="give the gains that drove the joint, --controller"):
        with_drive(log(), None)


def test_a_wrong_controller_is_noticed():
    c = Controller(output="torque_nm", kp=2.0)
    right = with_drive(log(), c)
    assert "agrees" in check_drive(right, c)[0]
    assert (
        "torque is measured: the drive is not computed" in check_drive(right, PRESETS["xl330"])[0]
    )
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


def test_the_controller_of_emps_agrees_with_its_log(measured_data):
    """To 0.4% in the median; with the velocity that its loop forms from tick to tick."""
    given = read_log(measured_data / "emps" / "DATA_EMPS.mat")
    known = read_controller(MODELS / "emps.controller.toml")
    assert difference(given, known) < 0.004
