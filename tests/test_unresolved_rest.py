"""Rest that the position does not resolve is left out, and what the filter mixes with it."""

from dataclasses import replace

import numpy as np
import pytest
from plants.draw import draw_trial
from trial_logs import prepared_logs

from frictionjoint.effects.signals import V
from frictionjoint.identify.fit import fit
from frictionjoint.identify.rest import resolved, without_rest


@pytest.fixture(scope="module")
def stuck(tmp_path_factory):
    """A joint on MuJoCo's own frictionloss: at rest its position stands, whatever the torque."""
    folder = tmp_path_factory.mktemp("stuck")
    spec = draw_trial(np.random.default_rng(409), "none")
    spec = replace(spec, friction=replace(spec.friction, law="plain"))
    return prepared_logs(spec, folder, 2)


def test_a_rest_harms_as_far_as_the_filter_reaches(stuck):
    everything = fit(stuck)
    moving, found = resolved(stuck, everything)
    assert moving.rest_speed > 0.0
    assert found.rms < 0.1 * everything.rms
    segments = tuple(
        replace(s, mask=s.mask & (np.abs(s.signals[:, V]) >= moving.rest_speed))
        for s in stuck.segments
    )
    with_neighbours = fit(replace(stuck, segments=segments), start=found.shape)
    assert found.rms < 0.6 * with_neighbours.rms


def test_the_neighbours_of_a_rest_go_with_it(stuck):
    speed, reach = 0.05, 2.0
    for before, after in zip(stuck.segments, without_rest(stuck, speed).segments, strict=True):
        rest = np.flatnonzero(np.abs(before.signals[:, V]) < speed)
        near = int(reach / (before.bandwidth_hz * before.dt))
        assert not after.mask[rest].any()
        assert not after.mask[np.clip(rest + near, 0, len(after.mask) - 1)].any()


def test_where_a_narrow_band_would_leave_little_fewer_go(stuck):
    narrow = replace(stuck, segments=tuple(replace(s, bandwidth_hz=2.0) for s in stuck.segments))
    alone = sum(int((s.mask & (np.abs(s.signals[:, V]) >= 0.05)).sum()) for s in narrow.segments)
    left = sum(int(s.mask.sum()) for s in without_rest(narrow, 0.05).segments)
    assert 0.6 * alone < left <= alone


def test_a_reversal_takes_no_neighbours_with_it(stuck):
    """The joint passes through zero speed at once: there is no torque of a stay to carry."""
    segment = stuck.segments[0]
    time = np.arange(len(segment.drive)) * segment.dt
    signals = segment.signals.copy()
    signals[:, V] = np.sin(2.0 * np.pi * segment.bandwidth_hz / 20.0 * time)
    swinging = replace(stuck, segments=(replace(segment, signals=signals),))
    left = without_rest(swinging, 0.03).segments[0].mask
    np.testing.assert_array_equal(left, segment.mask & (np.abs(signals[:, V]) >= 0.03))
