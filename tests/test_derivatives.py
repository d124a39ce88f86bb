"""Derivatives: no shift in time, stated bandwidth, the same filter for both sides."""

import numpy as np
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured import JointLog, differentiate, zero_phase
from frictionjoint.measured.derivatives import as_differenced, uniform_motion


def sine(n: int = 6000, dt: float = 0.001, jitter: float = 0.0, noise: float = 0.0) -> JointLog:
    """0.4 rad at 1 Hz, 0.1 rad at 3 Hz."""
    rng = np.random.default_rng(3)
    t = dt * np.arange(n) + jitter * dt * rng.uniform(-0.5, 0.5, n)
    q = 0.4 * np.sin(2 * np.pi * t) + 0.1 * np.sin(6 * np.pi * t)
    position = q + noise * rng.standard_normal(n)
    return JointLog(name="sine", joint="j", time=t, position=position, torque=np.cos(t))


def truth(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and acceleration of that motion."""
    w = 2 * np.pi
    v = 0.4 * w * np.cos(w * t) + 0.3 * w * np.cos(3 * w * t)
    return v, -0.4 * w**2 * np.sin(w * t) - 0.9 * w**2 * np.sin(3 * w * t)


@pytest.mark.parametrize("jitter", [0.0, 0.6])
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_velocity_and_acceleration_of_a_known_motion(jitter: float, noise: float) -> None:
    d = differentiate(sine(jitter=jitter, noise=noise))
    np.testing.assert_allclose(np.diff(d.time), d.time[1] - d.time[0], rtol=1e-9)
    inner = slice(300, -300)
    v, a = truth(d.time)
    assert np.sqrt(np.mean((d.velocity - v)[inner] ** 2)) < 0.01 * np.std(v)
    assert np.sqrt(np.mean((d.acceleration - a)[inner] ** 2)) < 0.05 * np.std(a)


def test_a_clock_that_jitters_adds_no_noise_to_the_acceleration() -> None:
    """A straight line between samples would add 4% here."""
    left = []
    for jitter in (0.0, 0.3):
        d = differentiate(sine(n=600, dt=0.01, jitter=jitter), 20.0)
        inner = slice(50, -50)
        left.append(np.std((d.acceleration - truth(d.time)[1])[inner]) / np.std(d.acceleration))
    assert left[1] < left[0] + 0.005


def test_a_bend_within_the_noise_of_a_count_is_not_made_up() -> None:
    log = sine(n=600, dt=0.01, jitter=0.3)
    grid = np.linspace(log.time[0], log.time[-1], 600)
    for count, straight in ((1e-5, False), (1e-2, True)):
        position = count * np.round(log.position / count)
        found = uniform_motion(log.time, position, grid)
        assert np.array_equal(found, np.interp(grid, log.time, position)) == straight


def test_a_gap_in_a_log_makes_no_waves() -> None:
    t = np.delete(0.01 * np.arange(600), slice(300, 315))
    grid = np.linspace(t[0], t[-1], 600)
    position = 0.1 * np.sin(t) + np.where(t < 3.0, 0.0, 1.0)
    smooth = uniform_motion(t, position, grid)
    away = np.abs(grid - 3.0) > 0.3
    np.testing.assert_allclose(smooth[away], (0.1 * np.sin(grid) + (grid > 3.0))[away], atol=1e-5)
    assert position.min() <= smooth.min() <= smooth.max() <= position.max()


def test_the_filter_shifts_nothing_in_time() -> None:
    t = 0.001 * np.arange(4000)
    x = np.sin(2 * np.pi * 2 * t)
    y = zero_phase(x, 0.001, 10.0)
    lags = np.arange(-30, 31)
    match = [np.dot(y[500:-500], np.roll(x, lag)[500:-500]) for lag in lags]
    assert lags[int(np.argmax(match))] == 0
    mirrored = zero_phase(x[::-1], 0.001, 10.0)[::-1]
    np.testing.assert_allclose(mirrored[500:-500], y[500:-500], atol=1e-6)


def test_the_stated_bandwidth_is_where_one_pass_halves_the_power() -> None:
    t = 0.001 * np.arange(8000)
    for bandwidth in (5.0, 20.0, 80.0):
        y = zero_phase(np.sin(2 * np.pi * bandwidth * t), 0.001, bandwidth)
        # two passes: the amplitude is halved
        assert np.std(y[2000:-2000]) * np.sqrt(2) == pytest.approx(0.5, abs=0.01)


def test_both_sides_of_the_balance_are_filtered_alike() -> None:
    """inertia * filtered acceleration equals the filtered torque of that inertia."""
    log = sine()
    d = differentiate(log, 15.0)
    torque = zero_phase(0.3 * truth(log.time)[1], 0.001, d.bandwidth_hz)
    inner = slice(500, -500)
    error = torque[inner] - 0.3 * d.acceleration[inner]
    assert np.std(error) < 2e-3 * np.std(torque[inner])


@pytest.mark.parametrize("per_sample", [0.1, 0.5, 1.0, 1.5])
def test_a_torque_is_averaged_as_an_acceleration_is(per_sample: float) -> None:
    """A wave of so many radians a sample loses as much by the average as by two differences."""
    phase = per_sample * np.arange(4000)
    differenced = np.gradient(np.gradient(np.sin(phase)))
    averaged = as_differenced(-(per_sample**2) * np.sin(phase))
    inner = slice(10, -10)
    lost = np.std(differenced[inner]) / (per_sample**2 * np.std(np.sin(phase)))
    kept = np.std(averaged[inner]) / (per_sample**2 * np.std(np.sin(phase)))
    assert kept == pytest.approx(lost, abs=0.006)
    assert kept == pytest.approx((np.sin(per_sample) / per_sample) ** 2, abs=0.006)


def test_columns_are_filtered_along_time() -> None:
    x = np.random.default_rng(0).standard_normal((500, 3))
    together = zero_phase(x, 0.01, 8.0)
    np.testing.assert_allclose(together[:, 1], zero_phase(x[:, 1], 0.01, 8.0), atol=1e-12)


def test_more_noise_takes_bandwidth_and_a_given_one_is_kept() -> None:
    quiet, noisy = (differentiate(sine(noise=noise)).bandwidth_hz for noise in (1e-6, 1e-2))
    assert noisy < quiet
    assert noisy >= 5.0
    assert differentiate(sine(), 12.5).bandwidth_hz == 12.5


@pytest.mark.parametrize("bandwidth", [0.0, -1.0, float("nan")])
def test_a_bandwidth_must_be_positive(bandwidth: float) -> None:
    with pytest.raises(LogError, match="positive"):
        differentiate(sine(), bandwidth)
