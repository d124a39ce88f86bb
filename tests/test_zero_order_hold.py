"""A torque that a controller holds from one sample to the next is a property of a log: it is
recognised, and balanced to the noise as any other; of a smooth drive nothing is changed."""

import numpy as np
import pytest

from frictionjoint.diagnose.verdict import noise_floor
from frictionjoint.identify.starts import fit
from tests.balance_grid import Spec, make
from tests.balance_grid.prepared import prepared


def logs_of(folder, spec):
    return prepared(make(spec, np.random.default_rng(1)), folder)


SMOOTH = [
    Spec("six-sines", 50.0, 20, False, False),
    Spec("chirp", 100.0, 18, False, False),
    Spec("steps", 50.0, 16, False, False),
    Spec("six-sines", 100.0, 18, True, False),
    Spec("one-speed", 50.0, 18, True, False),
]
HELD = [
    Spec("six-sines", 50.0, 20, False, True),
    Spec("chirp", 100.0, 18, False, True),
    Spec("triangle-rounded", 50.0, 24, False, True),
    Spec("steps", 50.0, 20, False, True),
]


@pytest.mark.parametrize("spec", HELD, ids=lambda spec: spec.name)
def test_a_held_torque_leaves_no_more_than_the_noise(spec, tmp_path):
    logs = logs_of(tmp_path, spec)
    assert logs.band.zero_order_hold
    found = fit(logs)
    assert found.rms < 1.2 * noise_floor(logs, 1.0)
    (delay,) = found.terms[-1].shape
    assert delay == pytest.approx(0.5 / spec.rate, abs=0.03 / spec.rate)


@pytest.mark.parametrize("spec", SMOOTH, ids=lambda spec: spec.name)
def test_a_smooth_torque_is_left_as_it_is(spec, tmp_path):
    assert not logs_of(tmp_path, spec).band.zero_order_hold


def test_of_a_fast_log_it_is_not_asked(tmp_path):
    assert not logs_of(tmp_path, Spec("sine-1-hz", 4000.0, 20, False, True)).band.zero_order_hold
