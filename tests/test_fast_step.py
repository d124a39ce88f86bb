"""The step of a simulation, quicker where no event is met, is the law's step but for rounding."""

import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.law.kernel import row_size
from frictionjoint.law.memory import HEADER, N_MAX, N_MIN
from frictionjoint.simulate import row
from frictionjoint.simulate.fast_step import usual_torque

KNOTS = ((2e-3, 1.5), (4e-3, 2.2), (8e-3, 3.2))
LAW = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma1=0.3, sigma2=0.2, n=2.0, knots=KNOTS
)


def simulated(quick, t, q, v):
    """Torque at each time, last row of state; a joint of 0.01 kg m^2."""
    P = np.concatenate([LAW.pack(), [0.0]])
    X, found = np.zeros(row.row_size(int(row_size(P, 0)), 0)), []
    for k in range(len(t)):
        point = (P, 0, len(P) - 1, X, 0, t[k], q[k], v[k])
        F = usual_torque(*point, 1e-3, 0.01, 100.0) if quick else np.nan
        found.append(F if F == F else row.rare_torque(*point, 1e-3, 1e-3, 0.01, 100.0))
    return np.array(found), X


def test_the_usual_step_of_a_joint_is_the_general_one():
    t = 1e-3 * np.arange(1, 6001)
    q = 0.05 * np.sin(2.0 * t) * (t < 3.0) + 2e-3 * np.sin(40.0 * t) * np.exp(-0.5 * t)
    q += np.cumsum(np.random.default_rng(5).normal(size=len(t))) * 2e-6 * (t > 4.0)
    v = np.gradient(q, t)
    usual, general = (simulated(quick, t, q, v) for quick in (True, False))
    np.testing.assert_allclose(usual[0], general[0], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(usual[1], general[1], rtol=0.0, atol=1e-9)


def test_rounding_at_rest_fills_no_memory_and_is_not_lost():
    t = 1e-3 * np.arange(1, 2001)
    steps = [np.full(200, 1e-6), np.tile([3e-18, -3e-18], 400), np.full(1000, 3e-18)]
    q, still = np.cumsum(np.concatenate(steps)), np.zeros(len(t))
    torque, X = simulated(True, t, q, still)
    assert max(X[row.FRONT + HEADER + N_MIN], X[row.FRONT + HEADER + N_MAX]) == 1.0
    assert np.abs(torque[200:1000] - torque[199]).max() < 1e-13
    # a creep too slow for any one step still loads the bristles
    tiny = 1e-16 * np.arange(1, 2001)
    assert simulated(True, t, tiny, still)[0][-1] == pytest.approx(1.5 / 2e-3 * tiny[-1], rel=1e-3)
