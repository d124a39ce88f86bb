"""Stick-slip of the KUKA joint: distances, times, and what native friction makes of it."""

import numpy as np
import pytest

from frictionjoint.simulate.stick_slip import SPEED, kuka_model, stick_slip


def test_slips_and_sticks_repeat():
    run = stick_slip(kuka_model())
    # stored: 0.1096 rad, 0.227 s, at 1 ms; slip is about vd pi sqrt(J/kp) and more
    assert len(run.slip_distances) >= 8
    np.testing.assert_allclose(run.slip_distances[1:], 0.1096, rtol=0.01)
    np.testing.assert_allclose(run.stick_times, 0.227, atol=0.01)
    # on average the joint keeps up with the target
    assert np.mean(run.slip_distances[1:]) / SPEED == pytest.approx(1.1, rel=0.05)


def test_native_frictionloss_does_not_stick():
    native = stick_slip(kuka_model(), native=True)
    assert len(native.slip_distances) == 0
