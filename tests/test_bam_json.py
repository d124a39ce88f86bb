"""JSON logs of servos: with a duty register, and with target and position only."""

import json

import numpy as np
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured.readers import read_log

COUNT = 2 * np.pi / 4096


def content(**more):
    time = np.arange(0.0, 2.0, 0.01)
    position = np.round(0.8 * np.sin(4 * time) / COUNT) * COUNT
    entries = [
        {
            "timestamp": float(t),
            "position": float(q),
            "speed": 0.0 if t == 0 else 3.2 * float(np.cos(4 * t)),
            "input_volts": 12.1 if t < 1 else 11.9,
            "temp": 37.0,
            "goal_position": float(np.sin(4 * t)),
            "torque_enable": bool(t < 1.5),
        }
        for t, q in zip(time, position, strict=True)
    ]
    return {"mass": 0.5, "kp": 16, "motor": "sts3215", "ip": "none", "entries": entries, **more}


def read(tmp_path, data):
    path = tmp_path / "log.json"
    path.write_text(json.dumps(data))
    return read_log(path, "pendulum")


def test_a_servo_without_a_duty_register_gives_target_and_supply(tmp_path):
    log = read(tmp_path, content())
    assert log.joint == "pendulum"
    assert log.voltage is log.torque is log.current is None
    assert log.metadata == {"mass": 0.5, "kp": 16.0}
    np.testing.assert_allclose(log.target, np.sin(4 * log.time))
    assert set(np.unique(log.supply)) == {11.9, 12.1}
    assert log.torque_enabled.sum() == 150


def test_the_load_of_another_servo_is_no_duty(tmp_path):
    data = content()
    for i, entry in enumerate(data["entries"]):
        entry["load"] = i % 100
    assert read(tmp_path, data).voltage is None
    assert read(tmp_path, {**data, "motor": "xl330"}).voltage is not None


def test_a_lost_byte_of_the_bus_is_interpolated_and_said(tmp_path):
    data = content()
    whole = read(tmp_path, data)
    data["entries"][77]["position"] = -3.14159
    log = read(tmp_path, data)
    assert abs(log.position[77] - whole.position[77]) < 2 * COUNT
    np.testing.assert_array_equal(np.delete(log.position, 77), np.delete(whole.position, 77))
    (note,) = log.notes
    assert "1 outlier (first in sample 78" in note
    assert whole.notes == ()


def test_a_step_is_no_lost_byte(tmp_path):
    data = content()
    for entry in data["entries"][100:]:
        entry["position"] += 0.5
    log = read(tmp_path, data)
    assert log.notes == ()
    positions = [entry["position"] for entry in data["entries"]]
    np.testing.assert_allclose(log.position[100:], positions[100:])


def test_a_file_without_entries_is_one_line(tmp_path):
    with pytest.raises(LogError, match="no list of entries"):
        read(tmp_path, {"kp": 3})
