"""What native friction gets wrong, ours does not: the figures of the documentation's page."""

import native_complaints as native
import numpy as np
import pytest


def test_holding_half_the_breakaway_for_a_minute_ends_where_it_settled():
    creep, drift, _, ours = native.creep()
    assert creep > 1e-2  # rad/s, for ever
    assert abs(drift) < 1e-9
    assert ours[-1, 0] == pytest.approx(0.5 * native.FS / 1e3, rel=1e-3)


def test_load_cycles_below_breakaway_leave_the_joint_where_it_was():
    drifting, ours, _, track = native.drift()
    assert drifting > 1e-4
    assert abs(ours) < 1e-9
    assert np.ptp(track[-200:]) > 1e-4  # it does move within a cycle


def test_stopping_distance_is_nearer_the_exact_one():
    theirs, ours = native.deceleration()
    assert theirs > 0.5
    assert abs(ours) < 0.15


def test_stiff_bristles_stay_bounded():
    theirs, ours = native.stiff()
    assert theirs == "diverges"
    assert ours.endswith("rad/s")


def test_parameters_are_checked():
    assert native.unchecked() == ("compiles", "Fc_pos is 1: it must be in (0, Fs_pos = 0.5]")
