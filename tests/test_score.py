"""What a model leaves of motion that neither its law nor its effects were fitted to."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.score import left_elsewhere
from frictionjoint.identify.search import ROUGH, Search, refit, timed
from frictionjoint.identify.starts import fit
from tests.plants.spec import Motion

MOTIONS = tuple(
    Motion(kind, seed, 0.5, 1.0, 10.0)
    for kind, seed in (("sines", 3), ("multisine", 4), ("ramps", 5))
)


@pytest.fixture(scope="module")
def three_logs(tmp_path_factory):
    return prepared_logs(replace(PENDULUM, motions=MOTIONS), tmp_path_factory.mktemp("plant"))


def test_each_of_three_logs_is_left_by_what_is_fitted_to_the_two_others(three_logs):
    fitted = fit(three_logs)
    blocks = make_blocks(three_logs, fitted)
    found = left_elsewhere(three_logs, fitted, blocks)
    left = 0.0
    for i in range(3):
        others = three_logs.subset([k for k in range(3) if k != i])
        rest = refit(others, (), fitted.shape, ROUGH)
        # coefficients of the two, on the columns of the third
        search = Search(three_logs.subset([i]), timed(others, rest.terms, rest.shape), rest.shape)
        X, y = search.balance.columns(rest.shape, rest.terms)
        left += float(np.sum((y - X @ rest.beta) ** 2))
    assert found == pytest.approx(left, rel=0.02)
    assert found > float(np.sum((fitted.residual * fitted.weight) ** 2))


def test_samples_that_are_left_out_count_for_nothing(three_logs):
    gone = np.concatenate(
        [np.full(int(s.kept.sum()), i == 1) for i, s in enumerate(three_logs.segments)]
    )
    without = three_logs.without_samples(gone)
    assert np.all(without.weight[gone] == 0.0)
    np.testing.assert_array_equal(without.weight[~gone], three_logs.weight[~gone])
    law = fit(three_logs).shape
    one = refit(without, (), law)
    other = refit(three_logs.subset([0, 2]), (), law)
    assert one.beta == pytest.approx(other.beta, rel=1e-3)
