"""The filter of the torque balance: one operator, exact to rounding, whatever it differentiates."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictionjoint.measured.lowpass import LowPass, gentle, steep

N, DT = 4000, 5e-3
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


def test_a_line_passes_whole_and_the_ends_make_no_waves():
    lowpass = LowPass(N, DT, 10.0, gentle)
    line = 0.4 + 2.0 * T
    np.testing.assert_allclose(lowpass(line), line, atol=1e-10)
    np.testing.assert_allclose(lowpass(line, 1), 2.0, atol=1e-9)
    slow = motion(waves=((1.0, 0.3),))
    np.testing.assert_allclose(lowpass(slow), slow, atol=2e-3)
