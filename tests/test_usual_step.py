"""The step of a simulation, quicker where no event is met, is the law's step but for rounding."""

import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.law import integrated
from frictionjoint.law.memory import CAPACITY, HEADER, make_room

KNOTS = ((2e-3, 1.5), (4e-3, 2.2), (8e-3, 3.2))


@pytest.mark.parametrize("n", [1.0, 2.0, 2.6])
@pytest.mark.parametrize("variant", ["ganseman1997", "lampaert2002"])
@pytest.mark.parametrize("virgin", ["literal", "masing"])
def test_both_steps_give_the_same_torque_and_memory(n, variant, virgin):
    P = fj.FrictionParameters.symmetric(
        Fs=1.5,
        Fc=1.0,
        Vs=0.05,
        sigma1=0.3,
        sigma2=0.2,
        n=n,
        knots=KNOTS,
        variant=variant,
        virgin=virgin,
    ).pack()
    rng = np.random.default_rng(3)
    # slides, presliding with loops in loops, rests
    t = np.arange(6000) * 1e-3
    q = 0.05 * np.sin(2.0 * t) * (t < 3.0) + 2e-3 * np.sin(40.0 * t) * np.exp(-0.5 * t)
    q += np.cumsum(rng.normal(size=len(t))) * 2e-6 * (t > 4.0)
    q[1000:1100] = q[1000]
    states = [np.zeros(2 * HEADER + 2 * CAPACITY) for _ in range(2)]
    torques = np.empty((2, len(t)))
    steps = (integrated.step, integrated.usual_step)
    for X, found, step in zip(states, torques, steps, strict=True):
        integrated.start(P, 1, X, 0, 2 * HEADER)
        found[0] = 0.0
        for k in range(1, len(t)):
            dq = q[k] - q[k - 1]
            found[k] = step(P, 1, X, 0, HEADER, 2 * HEADER, dq, 1e-3, dq / 1e-3)
            X[:HEADER] = X[HEADER : 2 * HEADER]
            make_room(X, 0, 2 * HEADER)
    np.testing.assert_allclose(torques[1], torques[0], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(states[1], states[0], rtol=0.0, atol=1e-12)
