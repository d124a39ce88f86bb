"""How much a sample counts: all of it in sliding, little where the position does not resolve it."""

from dataclasses import replace

import pytest
from plants.spec import Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
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
    logs, found = reweighed(logs, everything)
    logs, found = reweighed(logs, found)
    assert errors_of(logs, found).sliding < 0.1 * everything.rms
    assert found.coefficient("Fc") == pytest.approx(spec.friction.Fc, rel=0.02)
    assert found.coefficient("sigma2") == pytest.approx(spec.friction.sigma2, rel=0.1)
