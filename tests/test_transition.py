"""The transition curve Fd, and the level beside it."""

import numpy as np
import pytest

from frictionjoint.law.integrated import KNOTS as AT
from frictionjoint.law.stribeck import stribeck_level
from frictionjoint.law.transition import transition
from frictionjoint.parameters import FrictionParameters

KNOTS = ((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))
P = FrictionParameters.symmetric(Fs=5.0, Fc=3.0, Vs=0.01, delta=1.5, knots=KNOTS).pack()[1:]


@pytest.mark.parametrize("z", [0.0, 4e-6, 1e-5, 2e-5, 3e-5, 7e-5, 1e-4, 1.7e-4])
def test_through_the_knots_and_odd(z):
    zs, Fs = np.array([(0.0, 0.0), *KNOTS]).T
    wanted = np.interp(z, zs, Fs) + max(0.0, z - 1e-4) * 4.0 / 7e-5
    assert transition(P, AT, z) == pytest.approx(wanted, rel=1e-12)
    assert transition(P, AT, -z) == -transition(P, AT, z)


@pytest.mark.parametrize("delta", [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 10.0])
def test_stribeck_level(delta):
    block = np.array([5.0, 3.0, 0.01, delta, 0.0])
    for v in (0.0, 0.002, 0.01, 0.07, 1.0):
        wanted = 3.0 + 2.0 * np.exp(-((v / 0.01) ** delta))
        assert stribeck_level(block, 0, v) == pytest.approx(wanted, rel=1e-13)
