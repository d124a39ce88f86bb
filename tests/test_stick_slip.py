"""Stick-slip of the KUKA joint: distances, times, and what native friction makes of it."""

import numpy as np
import pytest

from frictionjoint.simulate.stick_slip import SPEED, kuka_model, stick_slip


@pytest.fixture(scope="module")
def run():
    return stick_slip(kuka_model())


def test_slips_and_sticks_repeat(run):
    # stored: 0.1096 rad, 0.227 s, at 1 ms; slip is about vd pi sqrt(J/kp) and more
    assert len(run.slip_distances) >= 8
    np.testing.assert_allclose(run.slip_distances[1:], 0.1096, rtol=0.01)
    np.testing.assert_allclose(run.stick_times, 0.227, atol=0.01)


def test_the_joint_keeps_up_with_the_target_on_average(run):
    period = np.mean(run.slip_distances[1:]) / SPEED
    assert period == pytest.approx(1.1, rel=0.05)


def test_native_frictionloss_does_not_stick():
    native = stick_slip(kuka_model(), native=True)
    assert len(native.slip_distances) == 0
