"""The drive around a sample: the mean of what a controller puts out in turn."""

import math

import numpy as np
import pytest

from frictionjoint.control import Controller
from frictionjoint.control.profile import held
from frictionjoint.control.reconstruct import commands
from frictionjoint.measured.log import JointLog

SAMPLE = 0.01
T = SAMPLE * np.arange(200)


@pytest.mark.parametrize(
    "known",
    [
        {"limit": 1.5},
        {"deadband": 0.2, "deadband_form": "cut"},
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
    log = JointLog(name="log", joint="j", time=T, position=position, target=target)
    controller = Controller(output="torque_nm", kp=5.0, **known)
    found = commands(log, controller).mean_drive()[1:]
    apart = np.abs(found - expected)[5:-5]
    assert apart.max() < 0.25 * np.abs(drive).max()
    assert np.sqrt(np.mean(apart**2)) < 0.05 * np.sqrt(np.mean(expected**2))
