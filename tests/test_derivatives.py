"""Motion of a measured position: a uniform grid, its derivatives, the band it lies in."""

import numpy as np
import pytest

from frictionjoint.measured.derivatives import differentiate, motion_band, uniform_motion
from frictionjoint.measured.log import JointLog
from tests.three_sines import sines

LINES = ((0.4, 1.0), (0.1, 3.0))


def sine(n: int = 6000, dt: float = 0.001, jitter: float = 0.0, noise: float = 0.0) -> JointLog:
    rng = np.random.default_rng(3)
    t = dt * np.arange(n) + jitter * dt * rng.uniform(-0.5, 0.5, n)
    position = sines(t, LINES)[0] + noise * rng.standard_normal(n)
    return JointLog(name="sine", joint="j", time=t, position=position, torque=np.cos(t))


@pytest.mark.parametrize("jitter", [0.0, 0.6])
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_velocity_and_acceleration_of_a_known_motion(jitter: float, noise: float) -> None:
    d = differentiate(sine(jitter=jitter, noise=noise))
    np.testing.assert_allclose(np.diff(d.time), d.time[1] - d.time[0], rtol=1e-9)
    inner = slice(300, -300)
    _, v, a = sines(d.time, LINES)
    assert np.sqrt(np.mean((d.velocity - v)[inner] ** 2)) < 0.01 * np.std(v)
    assert np.sqrt(np.mean((d.acceleration - a)[inner] ** 2)) < 0.05 * np.std(a)


def test_a_clock_that_jitters_adds_no_noise_to_the_acceleration() -> None:
    """A straight line between samples would add 4% here."""
    left = []
    for jitter in (0.0, 0.3):
        d = differentiate(sine(n=600, dt=0.01, jitter=jitter), 20.0)
        wrong = (d.acceleration - sines(d.time, LINES)[2])[50:-50]
        left.append(np.std(wrong) / np.std(d.acceleration))
    assert left[1] < left[0] + 0.005


def test_a_gap_in_a_log_makes_no_waves() -> None:
    t = np.delete(0.01 * np.arange(600), slice(300, 315))
    grid = np.linspace(t[0], t[-1], 600)
    position = 0.1 * np.sin(t) + np.where(t < 3.0, 0.0, 1.0)
    smooth = uniform_motion(t, position, grid)
    away = np.abs(grid - 3.0) > 0.3
    np.testing.assert_allclose(smooth[away], (0.1 * np.sin(grid) + (grid > 3.0))[away], atol=1e-5)
    assert position.min() <= smooth.min() <= smooth.max() <= position.max()


def test_more_noise_takes_bandwidth_and_a_given_one_is_kept() -> None:
    quiet, noisy = (differentiate(sine(noise=noise)).bandwidth_hz for noise in (1e-6, 1e-2))
    assert noisy < quiet
    assert noisy >= 5.0
    assert differentiate(sine(), 12.5).bandwidth_hz == 12.5


def test_the_band_of_a_motion_ends_where_its_noise_begins() -> None:
    """99% of the velocity's power is below 3 Hz; beyond 3 Hz there is noise alone."""
    band = motion_band(sine(n=20_000, noise=1e-5).position, 0.001)
    assert band.main == pytest.approx(3.0, abs=0.5)
    assert 6.0 < band.whole < 100.0
    noisy = motion_band(sine(n=20_000, noise=1e-2).position, 0.001)
    assert noisy.whole < band.whole
