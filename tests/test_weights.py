"""How much a sample counts: all of it in sliding, little where the position does not resolve it."""

from dataclasses import replace

import numpy as np
import pytest
from plants.spec import Friction, Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit, law_alone
from frictionjoint.identify.weights import errors_of, reweighed


@pytest.fixture(scope="module")
def stuck(tmp_path_factory):
    """A joint that goes from one rest to another, behind an encoder too coarse for presliding."""
    motions = tuple(Motion("pick-and-place", seed, 0.4, 0.8, 12.0) for seed in (3, 5))
    coarse = replace(PENDULUM.instrument, counts=2048)
    spec = replace(PENDULUM, motions=motions, instrument=coarse)
    logs = prepared_logs(spec, tmp_path_factory.mktemp("stuck"))
    return spec, logs, fit(logs, forms=INTEGRATED[:2])


def test_a_rest_that_no_position_resolves_does_no_harm(stuck):
    spec, logs, everything = stuck
    logs, found = law_alone(logs)
    assert errors_of(logs, found).sliding < 0.1 * everything.rms
    assert found.coefficient("Fc") == pytest.approx(spec.friction.Fc, rel=0.02)
    assert found.coefficient("sigma2") == pytest.approx(spec.friction.sigma2, rel=0.1)


def test_the_fall_after_a_breakaway_counts_less_than_sliding(tmp_path):
    """Every law is wrong while friction falls from static to sliding: dz/dq is negative there."""
    friction = Friction("lugre", Fs=1.2, Fc=0.5, Vs=0.03, delta=2.0, sigma2=0.1, presliding=4e-3)
    motions = tuple(Motion("sines", seed, 0.3, 0.15, 16.0) for seed in (3, 5))
    logs = prepared_logs(replace(PENDULUM, friction=friction, motions=motions), tmp_path)
    found = fit(logs)
    tracks = zip(logs.segments, logs.tracks(found.shape), strict=True)
    rate = np.concatenate([s.at_kept(along) for s, (_, along) in tracks])
    weights = reweighed(logs, found)[0].weight
    falling, sliding = rate < -0.15, np.abs(rate) < 0.01
    assert falling.sum() > 10
    assert weights[falling].max() < 0.98 * np.median(weights[sliding])
