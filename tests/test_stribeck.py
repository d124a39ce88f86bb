"""The level S(v) of sliding friction."""

import numpy as np
import pytest

from frictionjoint.law.stribeck import stribeck_level


@pytest.mark.parametrize("delta", [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 10.0])
def test_the_level_is_that_of_the_formula(delta):
    block = np.array([5.0, 3.0, 0.01, delta, 0.0])
    for v in (0.0, 0.002, 0.01, 0.07, 1.0):
        wanted = 3.0 + 2.0 * np.exp(-((v / 0.01) ** delta))
        assert stribeck_level(block, 0, v) == pytest.approx(wanted, rel=1e-13)
