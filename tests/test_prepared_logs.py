"""A log as a fit sees it: a balance that holds on slow logs, a law driven finely, coarse copies."""

import numpy as np
import pytest

from frictionjoint.effects.signals import LOAD, A, Q, V
from frictionjoint.identify.design import design
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
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
    return prepare([fast_log()], RigidBody(XML, "arm"), bandwidth_hz=60.0)


def test_inertia_leaves_nothing_on_a_slow_log(prepared):
    """At 200 Hz the acceleration of a motion at 23 Hz is a sixth short, and so is the torque."""
    (segment,) = prepared.segments
    inner = slice(50, -50)
    torque = segment.lowpass(segment.drive)[inner]
    load = segment.lowpass(segment.signals[:, LOAD], differenced=True)[inner]
    plain = segment.lowpass(segment.drive, differenced=True)[inner]
    assert np.std(plain - load) > 0.1 * np.std(torque)
    assert np.std(torque - load) < 0.008 * np.std(torque)


def test_a_law_is_driven_at_a_thousand_steps_a_second(prepared):
    (segment,) = prepared.segments
    time, position = segment.path
    np.testing.assert_allclose(np.diff(time), 1e-3, rtol=1e-9)
    np.testing.assert_array_equal(position[:: segment.refine], segment.signals[:, Q])
    slow = 0.3 * np.sin(3.0 * time)
    fast = (position - slow)[500:-500]
    assert np.std(fast) == pytest.approx(1e-3 / np.sqrt(2), rel=0.1)


@pytest.mark.parametrize("most", [10**6, 1500, 400])
def test_a_coarse_copy_keeps_the_slow_motion(prepared, most):
    (segment,), (coarse,) = prepared.segments, prepared.thinned(most).segments
    factor = round(coarse.dt / segment.dt)
    assert int(coarse.kept.sum()) <= 1.5 * most
    assert coarse.bandwidth_hz == pytest.approx(segment.bandwidth_hz / (factor / segment.step))
    if factor > 1:
        assert not coarse.averages
    inner = slice(20, -20)
    still = 0.9 * np.cos(3.0 * DT * factor * np.arange(len(coarse.signals)))
    if coarse.bandwidth_hz < 12.0:  # the fast part is gone
        np.testing.assert_allclose(coarse.signals[inner, V], still[inner], atol=0.03)
    torque = coarse.lowpass(coarse.drive)[inner]
    load = coarse.lowpass(INERTIA * coarse.signals[:, A], differenced=True)[inner]
    assert np.std(torque - load) < 0.03 * np.std(torque)


def test_columns_and_target_have_the_samples_kept(prepared):
    X, y = design(prepared, INTEGRATED[0], ())
    assert X.shape == (int(prepared.segments[0].kept.sum()), 3)
    assert y.shape == X.shape[:1]
