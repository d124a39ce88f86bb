"""How much a sample counts: all of it in sliding, little where the position does not resolve it."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.effects.signals import V
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
from frictionjoint.identify.weights import (
    DISCREPANCY,
    Errors,
    errors_elsewhere,
    errors_of,
    reweighed,
    weighted,
)
from tests.plants.spec import Motion


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
    logs, found = reweighed(logs, everything)
    logs, found = reweighed(logs, found)
    assert errors_of(logs, found).sliding < 0.1 * everything.rms
    assert found.coefficient("Fc") == pytest.approx(spec.friction.Fc, rel=0.02)
    assert found.coefficient("sigma2") == pytest.approx(spec.friction.sigma2, rel=0.1)


@pytest.fixture(scope="module")
def resolved(tmp_path_factory):
    """A LuGre joint that goes from one rest to another, and its own law."""
    motions = (Motion("pick-and-place", 3, 0.4, 0.8, 12.0),)
    logs = prepared_logs(replace(PENDULUM, motions=motions), tmp_path_factory.mktemp("resolved"))
    return logs, fit(logs, forms=forms_of("lugre"))


def test_what_slides_counts_whole_and_what_rests_does_not(resolved):
    logs, found = reweighed(*resolved)
    (segment,) = logs.segments
    speed = np.abs(segment.signals[:, V])
    near = int(1.0 / (segment.bandwidth_hz * segment.dt))

    def throughout(x):
        return np.convolve(~x, np.ones(2 * near + 1), "same") < 0.5

    slides, rests = throughout(speed > 0.1), throughout(speed < 1e-3)
    assert min(slides.sum(), rests.sum()) > 20
    assert np.median(segment.weight[slides]) > 0.99
    assert np.median(segment.weight[rests]) < 0.5
    np.testing.assert_array_equal(found.weight, segment.kept_weight)


def test_the_least_weight_is_that_of_what_the_encoder_leaves_and_of_a_law_that_is_not_exact(
    resolved,
):
    logs, found = resolved
    (segment,) = weighted(logs, found, Errors(0.01, 0.0)).segments
    level, stiffness = found.coefficient("Fc"), law_parameters(found).stiffness
    unresolved = min(stiffness * segment.noise.resolution, level)
    least = 1.0 / np.hypot(1.0, np.hypot(unresolved, DISCREPANCY * level) / 0.01)
    assert segment.weight.min() >= least * (1.0 - 1e-9)
    assert segment.weight.max() <= 1.0


def test_a_coarser_encoder_and_a_smaller_error_lower_the_weights(resolved):
    logs, found = resolved
    (own,) = weighted(logs, found, Errors(0.01, 0.0)).segments
    (segment,) = logs.segments
    blunt = replace(segment, noise=replace(segment.noise, count=2.0 * np.pi / 500.0))
    (coarse,) = weighted(replace(logs, segments=(blunt,)), found, Errors(0.01, 0.0)).segments
    (sure,) = weighted(logs, found, Errors(0.001, 0.0)).segments
    for other in (coarse, sure):
        # the filter behind which sticking is taken overshoots a little
        assert np.all(other.weight <= own.weight + 1e-3)
        assert np.mean(other.weight) < np.mean(own.weight) - 0.01


def test_weights_of_other_logs_follow_from_the_same_fit(resolved):
    logs, found = resolved
    once = weighted(logs, found, Errors(0.01, 0.0))
    again = weighted(once, found, Errors(0.01, 0.0))
    np.testing.assert_array_equal(once.segments[0].weight, again.segments[0].weight)


def test_logs_elsewhere_do_not_count_at_rest_where_the_stiffness_is_not_known(resolved):
    logs, found = resolved
    size = found.jacobian.shape[1]
    known = errors_elsewhere(logs, found, np.zeros((size, size)))
    assert known.sticking == pytest.approx(max(errors_of(logs, found)))
    unknown = errors_elsewhere(logs, found, 1e12 * np.eye(size))
    assert unknown.sticking >= found.levels[0]
    rests = np.abs(logs.segments[0].signals[:, V]) < 1e-3
    (loose,) = weighted(logs, found, unknown).segments
    (sure,) = weighted(logs, found, known).segments
    assert np.median(loose.weight[rests]) < np.median(sure.weight[rests])


def test_friction_that_the_motion_does_not_determine_does_not_count(resolved):
    logs, found = resolved
    (segment,) = logs.segments
    rests = np.arange(len(segment.signals)) < len(segment.signals) // 2
    beside = replace(segment, unknown=np.where(rests, 5.0 * found.levels[0], 0.0))
    (given,) = weighted(replace(logs, segments=(beside,)), found, errors_of(logs, found)).segments
    (alone,) = weighted(logs, found, errors_of(logs, found)).segments
    far = len(rests) // 10
    assert np.all(given.weight[rests][far:-far] < 0.1)
    later = np.flatnonzero(~rests)[far:-far]  # away from the filter's ends
    np.testing.assert_allclose(given.weight[later], alone.weight[later], rtol=1e-2)
