"""The drive around a sample: the mean of what a controller puts out in turn."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictionjoint.control import Controller
from frictionjoint.control.profile import held
from frictionjoint.control.reconstruct import commands
from frictionjoint.measured.log import JointLog

SAMPLE = 0.01
T = SAMPLE * np.arange(200)


def mean_drive(target, position, **controller):
    log = JointLog(name="log", joint="j", time=T, position=position, target=target)
    return commands(log, Controller(output="torque_nm", kp=5.0, **controller)).mean_drive()


def test_a_leap_of_the_target_holds_a_drive_at_its_limit_for_half_of_a_sample():
    """The mean error of that sample, 2 rad, is beyond the limit, too."""
    found = mean_drive(np.where(T > 0.5, 4.0, 0.0), np.zeros(len(T)), limit=3.0)
    leap = int(np.argmax(T > 0.5))
    np.testing.assert_allclose(found[leap - 1 : leap + 2], [0.0, 1.5, 3.0], atol=1e-12)


@pytest.mark.parametrize("delay", [0.001, 0.0043, 0.0117])
def test_a_drive_at_its_limit_depends_evenly_on_when_its_target_leaps(delay):
    found = mean_drive(np.where(T > 0.5, 4.0, 0.0), np.zeros(len(T)), limit=3.0, delay_s=delay)
    leap = int(np.argmax(T > 0.5))
    passed = T[leap - 1 : leap + 4] + 0.5 * SAMPLE - (T[leap] + delay)
    np.testing.assert_allclose(
        found[leap - 1 : leap + 4], 3.0 * np.clip(passed / SAMPLE, 0.0, 1.0), atol=1e-9
    )


def test_what_is_held_for_a_tick_was_read_half_a_tick_before_on_average():
    """Firmware at 250 Hz, begun at each of ten moments of its tick."""
    target, position = 0.8 * np.sin(7.0 * T), 0.8 * np.sin(7.0 * T - 0.5)
    h, tick = SAMPLE / 200.0, 80
    fine = h * (np.arange(200 * len(T)) + 0.5)
    drive = np.zeros(len(fine))
    for phase in range(4, tick, 8):
        at = np.maximum((np.arange(len(fine)) - phase) // tick * tick + phase, 0)
        error = held(T, target, fine[at]) - np.interp(fine[at], T, position)
        drive += 0.1 * 5.0 * error
    expected = drive[100:-100].reshape(-1, 200).mean(axis=1)
    found = mean_drive(target, position, rate_hz=1.0 / (tick * h))[1:]
    np.testing.assert_allclose(found[5:-5], expected[5:-5], atol=0.002 * np.abs(expected).max())


@given(st.integers(0, 1000), st.floats(0.0, 0.05))
def test_without_limits_it_is_the_drive_of_the_mean_error(seed, delay):
    rng = np.random.default_rng(seed)
    target, position = rng.normal(size=(2, len(T)))
    stairs = np.concatenate([[0.0], np.cumsum(target) * SAMPLE])
    begin, end = (T + way * 0.5 * SAMPLE - delay for way in (-1.0, 1.0))
    inner = slice(8, -1)
    corners = SAMPLE * np.arange(len(stairs))
    area = np.interp(end, corners, stairs) - np.interp(begin, corners, stairs)
    found = mean_drive(target, position, delay_s=delay)
    np.testing.assert_allclose(found[inner], 5.0 * (area / SAMPLE - position)[inner], atol=1e-9)


@pytest.mark.parametrize(
    "known",
    [
        {"limit": 1.5},
        {"deadband": 0.2},
        {"drop_above": 0.25, "drop_left": 0.4},
        {"target_rate": 2.0, "limit": 1.0},
    ],
)
def test_it_is_what_a_fine_controller_puts_out_on_average(known):
    """Of a joint that moves by 0.05 rad a sample: within what a quarter of a sample leaves."""
    target, position = 0.8 * np.sin(7.0 * T), 0.8 * np.sin(7.0 * T - 0.5)
    h = SAMPLE / 200.0
    fine = h * (np.arange(200 * len(T)) + 0.5)
    command = held(T, target, fine)
    if "target_rate" in known:
        here = target[0]
        for i, wanted in enumerate(command):
            here += min(known["target_rate"] * h, max(-known["target_rate"] * h, wanted - here))
            command[i] = here
    error = command - np.interp(fine, T, position)
    drive = 5.0 * np.where(np.abs(error) <= known.get("deadband", 0.0), 0.0, error)
    drive = np.clip(drive, -known.get("limit", math.inf), known.get("limit", math.inf))
    drive *= np.where(np.abs(error) > known.get("drop_above", math.inf), 0.4, 1.0)
    # from the middle of the first sample on
    expected = drive[100:-100].reshape(-1, 200).mean(axis=1)
    if "deadband" in known:
        known = {**known, "deadband_form": "cut"}
    found = mean_drive(target, position, **known)[1:]
    apart = np.abs(found - expected)[5:-5]
    assert apart.max() < 0.25 * np.abs(drive).max()
    assert np.sqrt(np.mean(apart**2)) < 0.05 * np.sqrt(np.mean(expected**2))
