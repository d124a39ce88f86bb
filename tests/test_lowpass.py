"""The filter of the torque balance: one operator, exact to rounding, whatever it differentiates."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictionjoint.measured.lowpass import LowPass, LowPasses, gentle, steep

N, DT, INERTIA = 4000, 5e-3, 0.3
T = DT * np.arange(N)
INNER = slice(400, -400)
# amplitude, rad, and frequency, Hz, of a motion up to nearly half of the Nyquist frequency
WAVES = ((0.3, 0.5), (0.02, 4.0), (1e-3, 23.0), (1e-4, 45.0))


def motion(derivative=0, delay=0.0, waves=WAVES):
    """A sum of sines, differentiated by hand."""
    w = 2.0 * np.pi
    phase = derivative * np.pi / 2.0
    return sum(a * (w * f) ** derivative * np.sin(w * f * (T - delay) + phase) for a, f in waves)


@pytest.mark.parametrize(
    ("corner", "response"), [(60.0, steep), (60.0, gentle), (20.0, gentle), (8.0, gentle)]
)
@pytest.mark.parametrize("derivative", [1, 2])
def test_a_derivative_is_that_of_the_filtered_signal(corner, response, derivative):
    """Half of the amplitude at 60 Hz may be lost, but on both sides the same."""
    lowpass = LowPass(N, DT, corner, response)
    found, expected = lowpass(motion(), derivative), lowpass(motion(derivative))
    np.testing.assert_allclose(found[INNER], expected[INNER], atol=1e-5 * np.std(expected))


def test_of_the_torque_of_an_inertia_nothing_is_left():
    """Motion and torque pass one filter, the balance a second one, as in a fit."""
    motion_filter, balance = LowPass(N, DT, 60.0, steep), LowPass(N, DT, 20.0, gentle, 2)
    torque = balance(motion_filter(INERTIA * motion(2)))
    load = balance(INERTIA * motion_filter(motion(), 2))
    assert np.std((torque - load)[200:-200]) < 1e-6 * np.std(torque)


@pytest.mark.parametrize("columns", [0, 1, 3])
def test_columns_are_filtered_one_by_one(columns):
    x = np.random.default_rng(columns).normal(size=(N, columns))
    lowpass = LowPass(N, DT, 20.0, gentle, 3)
    found = lowpass(x)
    assert found.shape == (len(lowpass(T)), columns)
    for k in range(columns):
        np.testing.assert_allclose(found[:, k], lowpass(x[:, k]), atol=1e-14)


@given(
    frequency=st.floats(0.5, 40.0),
    corner=st.floats(3.0, 60.0),
    response=st.sampled_from([gentle, steep]),
)
def test_the_amplitude_that_passes_is_as_stated(frequency, corner, response):
    waves = ((1.0, frequency),)
    passed = LowPass(N, DT, corner, response)(motion(waves=waves))
    expected = motion(waves=waves) * response(np.array(frequency / corner))
    # how far what is beyond the ends is seen goes with the period of the corner
    end = round(25.0 / corner / DT)
    np.testing.assert_allclose(passed[end:-end], expected[end:-end], atol=1e-5)


@given(delay=st.floats(-0.02, 0.02))
def test_a_delay_is_no_less_exact_between_samples(delay):
    lowpass = LowPass(N, DT, 30.0, gentle)
    found = lowpass.back(lowpass.spectrum(motion()), delay=delay)
    late = lowpass(motion(delay=delay))
    np.testing.assert_allclose(found[INNER], late[INNER], atol=1e-7)


@pytest.mark.parametrize("derivative", [0, 1, 2])
@pytest.mark.parametrize("step", [2, 3, 7])
def test_a_coarser_grid_has_every_so_many_th_sample(step, derivative):
    waves = WAVES[:2]
    fine = LowPass(N, DT, 5.0, steep)(motion(waves=waves), derivative)[::step]
    coarse = LowPass(N, DT, 5.0, steep, step)(motion(waves=waves), derivative)
    assert len(coarse) == len(fine)
    inner = slice(50, -50)
    np.testing.assert_allclose(coarse[inner], fine[inner], atol=1e-5 * np.std(fine))


def test_a_line_passes_whole_and_the_ends_make_no_waves():
    lowpass = LowPass(N, DT, 10.0, gentle)
    line = 0.4 + 2.0 * T
    np.testing.assert_allclose(lowpass(line), line, atol=1e-10)
    np.testing.assert_allclose(lowpass(line, 1), 2.0, atol=1e-9)
    slow = motion(waves=((1.0, 0.3),))
    np.testing.assert_allclose(lowpass(slow), slow, atol=2e-3)


def test_columns_are_filtered_along_time():
    x = np.random.default_rng(0).standard_normal((500, 3))
    lowpass = LowPass(500, 0.01, 8.0, gentle, 2)
    np.testing.assert_allclose(lowpass(x)[:, 1], lowpass(x[:, 1]), atol=1e-12)


def test_nothing_is_shifted_in_time():
    x = np.random.default_rng(0).standard_normal(3001)
    lowpass = LowPass(3001, 1e-3, 40.0, gentle)
    np.testing.assert_allclose(lowpass(x[::-1])[::-1], lowpass(x), atol=1e-4)


@pytest.mark.parametrize("n", [12, 40, 101])
def test_short_signals_keep_their_length(n):
    x = np.linspace(0.0, 1.0, n) ** 2
    for step in (1, 2, 5):
        assert LowPass(n, 0.01, 2.0, gentle, step)(x).shape == (-(-n // step),)


def test_what_lies_beyond_the_ends_is_not_seen_two_periods_away():
    """Of a kink at the end, as the continuation of an accelerating joint has, on a coarse grid."""
    corner, step = 10.0, 5
    lowpass = LowPass(N, DT, corner, gentle, step)
    bent = T**2
    spoilt = int(2.0 / (corner * DT * step)) + 1
    error = np.abs(lowpass(bent, 2) - 2.0) / 4.0  # there it changes from 2 to -2
    assert error[0] > 0.1
    assert error[spoilt:-spoilt].max() < 1e-3
    assert error[4 * spoilt : -4 * spoilt].max() < 5e-5


@pytest.mark.parametrize(
    ("derivative", "delay"), [(0, 0.0), (0, 7e-3), (1, 0.0), (1, 7e-3), (2, 0)]
)
def test_logs_one_behind_the_other_are_filtered_each_by_its_own(derivative, delay):
    """Of several lengths and clocks; some of them take a transform of one length."""
    kinds = ((900, 5e-3, 3), (904, 5.1e-3, 3), (700, 5e-3, 3), (900, 5e-3, 1), (904, 4.9e-3, 3))
    filters = [LowPass(n, dt, 6.0, gentle, step) for n, dt, step in kinds]
    assert len({(f.length, f.step) for f in filters}) < len(filters)
    x = np.random.default_rng(0).normal(size=(2, sum(n for n, _, _ in kinds))).cumsum(axis=1)
    together = LowPasses(filters)
    found = together.back(together.spectra(x), derivative, delay)
    edges = np.cumsum([0, *(n for n, _, _ in kinds)])
    for k, row in enumerate(x):
        alone = [
            one.back(one.spectrum(row[first:end]), derivative, delay)
            for one, first, end in zip(filters, edges[:-1], edges[1:], strict=True)
        ]
        np.testing.assert_allclose(found[k], np.concatenate(alone), rtol=1e-12)
