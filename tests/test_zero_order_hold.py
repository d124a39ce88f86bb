"""A torque that a controller holds from one sample to the next is a property of a log: it is
recognised, and balanced to the noise as any other; of a smooth drive nothing is changed."""

import numpy as np
import pytest

from frictionjoint.diagnose.report_parts import noise_floor
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, logged, sines

SECONDS = 20.0
NOISE = 0.005
FREQUENCIES = np.geomspace(0.1, 5.6, 6)


def six_sines(t):
    return sines(t, [(0.07 / f, f) for f in FREQUENCIES])


def chirp(t):
    """From 0.1 to 9 Hz; position, velocity and acceleration."""
    low, rise = 0.1, 8.9 / SECONDS
    angle, w = 2.0 * np.pi * (low + 0.5 * rise * t) * t, 2.0 * np.pi * (low + rise * t)
    s, c = 0.05 * np.sin(angle), 0.05 * np.cos(angle)
    return s, w * c, 2.0 * np.pi * rise * c - w**2 * s


def steps(t):
    """Rests joined by steps of least jerk, one per second."""
    rng = np.random.default_rng(2)
    begin = np.arange(SECONDS) + rng.uniform(0.1, 0.4, int(SECONDS))
    length, height = rng.uniform(0.2, 0.5, len(begin)), rng.uniform(-0.5, 0.5, len(begin))
    s = ((t[:, None] - begin) / length).clip(0.0, 1.0)
    q, v = s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2 / length
    return q @ height, v @ height, 60 * s * (1 - s) * (1 - 2 * s) / length**2 @ height


def logs_of(folder, motion, rate, bits, held, friction=0.0):
    """A known inertia along a formula; held: constant acceleration and torque between samples."""
    t = np.arange(0.0, SECONDS, 1.0 / rate)
    q, v, a = motion(t)
    if held:
        q = q[0] + np.r_[0.0, np.cumsum(0.5 * (v[:-1] + v[1:]) / rate)]
        a = np.diff(v, append=v[-1]) * rate
    torque = INERTIA * a + friction * np.tanh(v / 1e-3)
    size = float(np.sqrt(np.mean(torque**2)))
    torque += NOISE * size * np.random.default_rng(1).standard_normal(len(t))
    count = 2.0 * np.pi / 2**bits
    return logged(folder, torque, count * np.round(q / count), time=t)


HELD = [(six_sines, 50.0, 20), (chirp, 100.0, 18), (steps, 50.0, 20)]
SMOOTH = [(six_sines, 50.0, 20, 0.0), (chirp, 100.0, 18, 0.0), (steps, 50.0, 16, 0.0)]
SMOOTH += [(six_sines, 100.0, 18, 0.5)]


@pytest.mark.parametrize(("motion", "rate", "bits"), HELD)
def test_a_held_torque_leaves_no_more_than_the_noise(motion, rate, bits, tmp_path):
    logs = logs_of(tmp_path, motion, rate, bits, held=True)
    assert logs.band.zero_order_hold
    found = fit(logs)
    assert found.rms < 1.2 * noise_floor(logs, 1.0)
    (delay,) = found.terms[-1].shape
    assert delay == pytest.approx(0.5 / rate, abs=0.03 / rate)


@pytest.mark.parametrize(("motion", "rate", "bits", "friction"), SMOOTH)
def test_a_smooth_torque_is_left_as_it_is(motion, rate, bits, friction, tmp_path):
    assert not logs_of(tmp_path, motion, rate, bits, False, friction).band.zero_order_hold
