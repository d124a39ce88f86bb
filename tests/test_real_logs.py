"""Measured logs of real machines: the loop runs, and its model is better on what it never saw."""

import pytest

from frictionjoint import close_loop
from frictionjoint.measured.log import split_in_time
from frictionjoint.measured.readers import read_log
from frictionjoint.simulate.stick_slip import kuka_model

MODELS = kuka_model().parent


@pytest.fixture(scope="module")
def emps(measured_data):
    log = read_log(measured_data / "emps" / "DATA_EMPS.mat", "carriage")
    fitted, held_out = split_in_time(log, 1 / 3)
    # half of what `lab/real_logs.py` fits tells the same in half the time
    fitted, _ = split_in_time(fitted, 0.5)
    return close_loop([fitted], MODELS / "emps.xml", "carriage", [held_out])


def test_emps_is_explained_well_below_the_usual_model(emps):
    # the usual four-parameter model leaves 4.4% of the force (see the benchmark's description)
    assert emps.after_torque.held_out < 0.044 * emps.measured_rms
    assert emps.after_torque.held_out < 0.5 * emps.before_torque.held_out
    assert emps.after_replay.held_out < 0.5 * emps.before_replay.held_out


def test_emps_shows_its_asymmetry(emps):
    assert emps.added[0].effect == "direction-asymmetry"


def test_panda_joint_4_is_known_to_two_per_cent(measured_data):
    report = close_loop([measured_data / "panda"], MODELS / "panda.xml", "joint4", held_out=0.3)
    assert report.after_torque.held_out < 0.02 * report.measured_rms
