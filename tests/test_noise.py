"""What the instruments of a log are: read from the log alone, against what was put in."""

from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.diagnose.verdict import noise_floor
from frictionjoint.identify.noise import count_of, density_above, noise_of
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Band
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, gentle

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
    error = segment.balanced_drive()[segment.kept] - segment.balanced_load
    return logs, float(np.std(error))


@pytest.mark.parametrize("noise", [2e-3, 2e-2])
def test_the_density_of_white_noise_is_read_above_the_motion(noise):
    # one-sided: the variance over half of the sampling rate
    found = density_above(log(noise=noise).torque, DT)
    assert found == pytest.approx(2.0 * noise**2 * DT, rel=0.05)


@pytest.mark.parametrize("samples", [300, 1000, 2000, 6000])
def test_the_density_of_a_short_log_is_right_on_average(samples):
    rng = np.random.default_rng(samples)
    found = [density_above(rng.standard_normal(samples), DT) for _ in range(100)]
    assert np.mean(found) == pytest.approx(2.0 * DT, rel=0.06)


def test_a_line_above_the_motion_is_passed_over():
    hum = 0.1 * np.sin(2.0 * np.pi * 150.0 * T)
    found = density_above(log().torque + hum, DT)
    assert found == pytest.approx(2.0 * 0.02**2 * DT, rel=0.1)


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


def test_a_coarser_encoder_narrows_the_band_and_a_noisier_torque_widens_it():
    def band(counts, noise):
        (segment,) = left_of(log(counts, noise), Band(20.0, 100.0))[0].segments
        return segment.noise.band_hz(0.5, 60.0)

    assert band(1024, 0.02) < 0.7 * band(65536, 0.02)
    assert band(1024, 0.2) > band(1024, 2e-3)
    assert 0.5 <= band(256, 1e-4) < band(2**20, 1e-4) <= 60.0


def test_in_its_band_the_position_adds_little_to_what_the_torque_leaves():
    """A twentieth of the power."""
    for counts in (4096, 16384):
        (segment,) = left_of(log(counts, 0.02), Band(20.0, 100.0))[0].segments
        corner = segment.noise.band_hz(1.0, 60.0)
        torque, position = segment.noise.left(corner)
        assert 1.0 < corner < 60.0
        assert 0.03 * torque < position <= 0.05 * torque


def test_what_is_left_of_a_density_is_its_part_that_passes():
    rng = np.random.default_rng(1)
    white = rng.standard_normal(N)
    found = noise_of(white, motion(), motion(), DT, 0.0, 0.0).left(30.0)[0]
    assert found == pytest.approx(np.var(LowPass(N, DT, 30.0, gentle)(white)), rel=0.1)


def test_the_inertia_behind_the_noise_is_taken_apart_from_gravity():
    """Swinging about the vertical, the torque of gravity goes with the acceleration."""
    pendulum = XML.replace('gravity="0 0 0"', "").replace('pos="0 0 0"', 'pos="0 0 -0.3"')
    whole = INERTIA + 0.3**2
    one = replace(log(), torque=whole * motion(2) + 9.81 * 0.3 * np.sin(motion()))
    (segment,) = prepare([one], RigidBody(pendulum, "arm")).segments
    assert segment.noise.inertia == pytest.approx(whole, rel=1e-3)
