"""A log as a fit sees it: a balance that holds on slow logs, a law driven finely, coarse copies."""

from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.effects.signals import LOAD, TIME, A, Q, V
from frictionjoint.identify.design import Balance
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.reversals import fill_grid
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Band
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.measured.log import JointLog

INERTIA, DT = 0.3, 5e-3
XML = f"""
<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="arm" axis="0 -1 0"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.2 {INERTIA} 0.2"/></body></worldbody></mujoco>"""


def fast_log(rate_hz=23.0, n=4000):
    """A body turned to and fro at a fifth of the sampling rate, with the torque that takes."""
    t = DT * np.arange(n)
    w = 2 * np.pi * rate_hz
    q = 0.3 * np.sin(3.0 * t) + 1e-3 * np.sin(w * t)
    a = -2.7 * np.sin(3.0 * t) - 1e-3 * w**2 * np.sin(w * t)
    return JointLog(name="fast", joint="arm", time=t, position=q, torque=INERTIA * a)


@pytest.fixture(scope="module")
def prepared():
    return prepare([fast_log()], RigidBody(XML, "arm"), Band(balance=60.0, motion=80.0))


def test_inertia_leaves_nothing_on_a_slow_log(prepared):
    """At 200 Hz two differences of a motion at 23 Hz are a twelfth short: the filter's are not."""
    (segment,) = prepared.segments
    inner = slice(50, -50)
    torque = segment.lowpass(segment.drive)[inner]
    load = segment.lowpass(segment.signals[:, LOAD])[inner]
    q = segment.signals[:, Q]
    differences = segment.lowpass(INERTIA * np.gradient(np.gradient(q, DT), DT))[inner]
    assert np.std(torque - differences) > 0.05 * np.std(torque)
    assert np.std(torque - load) < 1e-4 * np.std(torque)
    np.testing.assert_array_equal(
        segment.balanced_load, segment.lowpass(segment.signals[:, LOAD])[segment.kept]
    )


def test_a_law_is_driven_at_four_hundred_steps_a_second_or_more(prepared):
    (segment,) = prepared.segments
    path = segment.path
    assert np.all(np.diff(path.time) <= 2.5e-3 * (1.0 + 1e-9))
    on_grid = np.empty((1, len(segment.signals)))
    fill_grid(path.time[None], path.samples, path.averaged, on_grid)
    np.testing.assert_allclose(on_grid[0], segment.signals[:, TIME], atol=1e-9)
    position = segment.signals[:, Q]
    assert set(position) <= set(path.position)
    slow = 0.3 * np.sin(3.0 * segment.signals[:, TIME])
    fast = (position - slow)[200:-200]
    assert np.std(fast) == pytest.approx(1e-3 / np.sqrt(2), rel=0.1)


@pytest.mark.parametrize("most", [10**6, 1500, 400])
def test_a_coarse_copy_keeps_the_slow_motion(prepared, most):
    (segment,), (coarse,) = prepared.segments, prepared.thinned(most).segments
    factor = max(1.0, prepared.samples / most)
    assert int(coarse.kept.sum()) <= 1.5 * most
    assert coarse.bandwidth_hz == pytest.approx(segment.bandwidth_hz / factor)
    inner = slice(20, -20)
    time = coarse.dt * np.arange(len(coarse.signals))
    if coarse.bandwidth_hz < 12.0:  # the fast part is gone
        slow = coarse.lowpass(coarse.signals[:, V])
        expected = coarse.lowpass(0.9 * np.cos(3.0 * time))
        np.testing.assert_allclose(slow[inner], expected[inner], atol=0.03)
    torque = coarse.lowpass(coarse.drive)[inner]
    load = coarse.lowpass(INERTIA * coarse.signals[:, A])[inner]
    assert np.std(torque - load) < 0.03 * np.std(torque)


def test_columns_and_target_have_the_samples_kept(prepared):
    X, y = Balance(prepared, INTEGRATED[0], ()).columns(INTEGRATED[0], ())
    assert X.shape == (prepared.samples, len(layout_of(prepared, INTEGRATED[0], ()).base))
    assert y.shape == X.shape[:1]


def test_logs_compared_with_others_take_their_band():
    body = RigidBody(XML, "arm")
    first = prepare([fast_log()], body)
    other = prepare([fast_log(5.0, 2000)], body, first.band)
    assert other.band == first.band
    assert other.segments[0].bandwidth_hz == first.segments[0].bandwidth_hz
    assert other.segments[0].corner_hz == first.segments[0].corner_hz


def test_the_band_holds_the_motion():
    """What moves at 23 Hz is no noise, and a torque that goes with it no error."""
    assert prepare([fast_log()], RigidBody(XML, "arm")).band.motion > 2.0 * 23.0


def test_the_drive_of_an_earlier_time_passes_the_same_filter(prepared):
    (segment,) = prepared.segments
    time = segment.signals[:, TIME]
    wave = replace(segment, drive=np.sin(20.0 * time))
    late = replace(segment, drive=np.sin(20.0 * (time - 7e-3)))
    inner = slice(300, -300)
    np.testing.assert_allclose(
        wave.balanced_drive(7e-3)[inner], late.balanced_drive()[inner], atol=1e-6
    )
    rate = replace(segment, drive=20.0 * np.cos(20.0 * time))
    np.testing.assert_allclose(
        wave.balanced_drive(0.0, 1)[inner], rate.balanced_drive()[inner], atol=2e-4
    )
