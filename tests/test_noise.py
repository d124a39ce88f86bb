"""What the instruments of a log are: read from the log alone, against what was put in."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.report_parts import noise_floor, verdict
from frictionjoint.identify.noise import Band, count_of, density_above
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.measured.log import JointLog

INERTIA, RATE, N = 0.05, 500.0, 20_000
DT = 1.0 / RATE
T = DT * np.arange(N)
XML = f"""
<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="arm" axis="0 -1 0"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.05 {INERTIA} 0.05"/></body></worldbody></mujoco>"""


def motion(derivative=0):
    w, phase = 2.0 * np.pi * np.array([0.31, 0.83, 1.7]), derivative * np.pi / 2.0
    amplitude = np.array([0.8, 0.3, 0.1]) * w**derivative
    return (amplitude * np.sin(w * T[:, None] + phase)).sum(axis=1)


def log(counts=65536, noise=0.02, seed=0):
    """A body turned without any friction: its torque is its inertia's, and noise."""
    rng = np.random.default_rng(seed)
    step = 2.0 * np.pi / counts
    return JointLog(
        name="free",
        joint="arm",
        time=T,
        position=step * np.round(motion() / step),
        torque=INERTIA * motion(2) + noise * rng.standard_normal(N),
    )


def left_of(one, band=None):
    """The log prepared, and what its true model leaves of it behind the balance's filter."""
    logs = prepare([one], RigidBody(XML, "arm"), band)
    (segment,) = logs.segments
    error = segment.balanced_drive() - segment.balanced_load
    return logs, float(np.std(error))


@pytest.mark.parametrize("noise", [2e-3, 2e-2])
def test_the_density_of_white_noise_is_read_above_the_motion(noise):
    # one-sided: the variance over half of the sampling rate
    found = density_above(log(noise=noise).torque, DT)
    assert found == pytest.approx(2.0 * noise**2 * DT, rel=0.05)


def test_single_wrong_readings_are_no_noise():
    clean = log(noise=0.01).torque
    spiked = clean.copy()
    spiked[np.random.default_rng(4).integers(100, N - 100, 20)] += 10.0 * np.ptp(clean)
    assert density_above(spiked, DT) == pytest.approx(density_above(clean, DT), rel=0.02)


@pytest.mark.parametrize("counts", [4096, 65536])
def test_the_count_of_an_encoder_is_the_least_step(counts):
    assert count_of(log(counts).position) == pytest.approx(2.0 * np.pi / counts, rel=1e-6)
    assert count_of(motion() + 1e-4 * np.random.default_rng(0).standard_normal(N)) == 0.0


@pytest.mark.parametrize(
    ("counts", "noise"), [(2**20, 0.02), (65536, 0.02), (65536, 2e-3), (4096, 0.02)]
)
def test_the_floor_is_what_the_true_model_leaves(counts, noise):
    logs, left = left_of(log(counts, noise))
    assert noise_floor(logs, 1.0) == pytest.approx(left, rel=0.2)


@pytest.mark.parametrize("balance", [10.0, 25.0, 50.0])
def test_the_floor_of_an_encoder_alone(balance):
    """Without any noise of the torque only the beats of the counts are left."""
    logs, left = left_of(log(4096, 0.0), Band(balance, 100.0))
    assert noise_floor(logs, 1.0) == pytest.approx(left, rel=0.2)


def test_a_log_whose_motion_reaches_above_its_band_tells_no_noise():
    """The chatter of a controller is torque at all frequencies, and no noise of the instruments."""
    quiet, chatter = log(), replace(log(noise=0.2, seed=1), name="chatter")
    alone, left = left_of(quiet)
    both = prepare([quiet, chatter], RigidBody(XML, "arm"), alone.band)
    assert noise_floor(both, 1.0) == pytest.approx(left, rel=0.2)
    # logs of equal noise keep theirs
    louder = replace(log(noise=0.022, seed=2), name="louder")
    floors = [noise_floor(left_of(x, alone.band)[0], 1.0) for x in (quiet, louder)]
    pair = prepare([quiet, louder], RigidBody(XML, "arm"), alone.band)
    assert noise_floor(pair, 1.0) == pytest.approx(np.sqrt(np.mean(np.square(floors))), rel=1e-9)


@pytest.mark.parametrize(
    ("error", "expected"),
    [(0.01, "partly-explained"), (0.09, "explained"), (0.2, "partly-explained")],
)
def test_an_error_far_below_the_noise_is_not_at_the_noise(monkeypatch, error, expected):
    monkeypatch.setattr("frictionjoint.diagnose.report_parts.noise_floor", lambda *of: 0.1)
    monkeypatch.setattr("frictionjoint.diagnose.report_parts._is_white", lambda *of: False)
    final = SimpleNamespace(rms_in_motion=error, target_rms=10.0, gain=1.0, effects=())
    found = SimpleNamespace(findings=(1,), unexplained=(), final=final, prepared=None)
    errors = Rms(error, error), Rms(error, error)
    assert verdict(found, errors, errors, False) == expected


def test_the_inertia_behind_the_noise_is_taken_apart_from_gravity():
    """Swinging about the vertical, the torque of gravity goes with the acceleration."""
    pendulum = XML.replace('gravity="0 0 0"', "").replace('pos="0 0 0"', 'pos="0 0 -0.3"')
    whole = INERTIA + 0.3**2
    one = replace(log(), torque=whole * motion(2) + 9.81 * 0.3 * np.sin(motion()))
    (segment,) = prepare([one], RigidBody(pendulum, "arm")).segments
    assert segment.noise.inertia == pytest.approx(whole, rel=1e-3)
