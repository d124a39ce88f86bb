"""Stacks of extrema: start, overflow, and the loss it costs."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.integrated_solver import reference_torque

from frictionjoint.law import memory as m
from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.parameters import FrictionParameters

KNOTS = ((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))
LAW = FrictionParameters.symmetric(Fs=5.0, Fc=5.0, Vs=0.01, n=8.0, knots=KNOTS)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.9, 0.9999), st.integers(30, 150))
def test_what_is_given_up_costs_less_than_stated(seed, shrink, reversals):
    """Any spiral in and out again, with some noise: within the bound of the full memory."""
    rng = np.random.default_rng(seed)
    turns = 1.4e-5 * shrink ** np.arange(reversals) * (-1.0) ** np.arange(reversals)
    turns *= rng.uniform(0.9, 1.0, reversals)
    q = np.concatenate(([0.0], turns, -turns[::-1]))
    P = LAW.pack()
    X = np.zeros(row_size(P, 0))
    start_row(P, 0, X, 0)
    wanted, _ = reference_torque(LAW, np.arange(len(q)) * 1.0, q)
    for dq, F in zip(np.diff(q), wanted[1:], strict=True):
        got = step_row(P, 0, X, 0, dq, 1.0, dq)
        commit(P, 0, X, 0)
        assert abs(got - F) <= min(X[m.BOUND], 0.2 * LAW.Fs_pos) + 1e-5
