"""Readers on the real files, and what is known of their content."""

import json
from pathlib import Path

import numpy as np
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured.readers import read_log


def servo_duty(path: Path, skew: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Recorded duty, and the one the firmware's proportional law makes of the position error.

    Args:
        skew: s by which the position is taken later than its time stamp.
    """
    log = read_log(path)
    assert log.target is not None
    assert log.voltage is not None
    assert log.torque_enabled is not None
    supply = np.array([entry["input_volts"] for entry in json.loads(path.read_text())["entries"]])
    position = np.interp(log.time + skew, log.time, log.position)
    expected = log.metadata["kp"] * 4096 / (2 * np.pi) / (256 * 885) * (log.target - position)
    assert not log.voltage[~log.torque_enabled].any()
    clear = log.torque_enabled & (np.abs(expected) < 0.9)
    return (log.voltage / supply)[clear], expected[clear]


def test_the_servo_duty_follows_its_controller(measured_data: Path) -> None:
    """duty = kp 4096 / (2 pi) / (256 * 885) (goal - position) to 0.5%, where motion is slow."""
    for name in ("10h28m10", "10h28m24", "10h28m42", "10h28m57"):
        duty, expected = servo_duty(measured_data / "xl330" / f"2026-01-15_{name}.json")
        assert duty @ expected / (expected @ expected) == pytest.approx(1.0, abs=0.005)
        assert np.std(duty - expected) < 0.005 * np.std(duty)


def test_the_servo_position_is_read_before_the_duty(measured_data: Path) -> None:
    """In fast motion the law holds for the position 2.3 ms after the stamp, not at it."""
    for name in ("10h28m32", "10h29m04", "10h29m37"):
        path = measured_data / "xl330" / f"2026-01-15_{name}.json"
        misses = [float(np.std(np.subtract(*servo_duty(path, skew)))) for skew in (0.0, 0.0023)]
        assert misses[1] < 0.5 * misses[0]
        duty, expected = servo_duty(path, 0.0023)
        assert duty @ expected / (expected @ expected) == pytest.approx(1.0, abs=0.005)


def test_all_servo_logs_can_be_read(measured_data: Path) -> None:
    files = sorted((measured_data / "xl330").glob("*.json"))
    logs = [read_log(file) for file in files]
    assert [log.metadata["kp"] for log in logs] == [100] * 4 + [200] * 4 + [400] * 4 + [800] * 4
    for log in logs:
        assert log.velocity is not None
        slope = np.gradient(log.position, log.time)
        assert slope @ log.velocity / (log.velocity @ log.velocity) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("i", range(1, 8))
def test_panda(measured_data: Path, i: int) -> None:
    log = read_log(measured_data / "panda", f"joint{i}")
    assert len(log.time) == 20544
    assert log.torque is not None
    assert log.velocity is not None
    assert len(log.other_positions) == len(log.other_velocities) == 6
    slope = np.gradient(log.position, log.time)
    assert np.corrcoef(slope, log.velocity)[0, 1] > 0.95
    with pytest.raises(LogError, match="joint1, joint2"):
        read_log(measured_data / "panda", "elbow")


def test_the_bag_and_the_table_of_the_ur10_agree(measured_data: Path) -> None:
    bag = read_log(measured_data / "unisa_ur10" / "ur10_exciting_trajectory.db3", "elbow_joint")
    table = read_log(measured_data / "unisa_ur10" / "ur10.csv", "j3")
    assert bag.torque is not None
    np.testing.assert_allclose(bag.time, table.time, atol=1e-8)
    np.testing.assert_allclose(bag.position, table.position, rtol=1e-8)
    np.testing.assert_allclose(bag.torque, table.torque, rtol=1e-8, atol=1e-8)


def test_kuka_has_a_second_encoder_on_three_axes(measured_data: Path) -> None:
    path = measured_data / "kuka_kr300" / "A.csv"
    log = read_log(path, "axis1")
    assert log.motor_position is not None
    assert 0.0 < np.abs(log.motor_position - log.position).max() < 0.05
    with pytest.raises(LogError, match=r"axis5\.position_rad: constant at 0"):
        read_log(path, "axis5")
