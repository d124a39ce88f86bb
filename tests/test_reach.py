"""How near a fit has come to its minimum, to first order."""

import numpy as np
import pytest

from frictionjoint.identify.reach import unreached
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, T, V, logged


@pytest.mark.parametrize("level", [0.0, 0.3], ids=["no level", "level"])
def test_the_numbers_of_a_law_without_a_level_promise_nothing(tmp_path, level):
    """Next to nothing moves with them, in directions that a missing inertia has a part in."""
    friction = level * np.clip(V / 0.02, -1.0, 1.0)
    noise = np.random.default_rng(3).normal(0.0, 0.005, len(T))
    found = fit(logged(tmp_path, 3.0 * INERTIA * A + friction + noise))
    left = np.sum((found.residual * found.weight) ** 2)
    assert np.sum(unreached(found)) < 0.05 * left
    assert found.free_jacobian.shape[1] < found.jacobian.shape[1]
