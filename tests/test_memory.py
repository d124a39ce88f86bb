"""Stacks of extrema: overflow, the loss it costs, and what a simulated joint tells of them."""

import mujoco
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.integrated_solver import reference_torque

import frictionjoint as fj
from frictionjoint.law import memory as m
from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.parameters import FrictionParameters

KNOTS = ((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))
LAW = FrictionParameters.symmetric(Fs=5.0, Fc=5.0, Vs=0.01, n=8.0, knots=KNOTS)
JOINT = """<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body>
<joint name="j"/><geom size="0.1" mass="1"/></body></worldbody></mujoco>"""


def stepped(q):
    """The law's torque and state, step by step along positions a second apart."""
    P = LAW.pack()
    X = np.zeros(row_size(P, 0))
    start_row(P, 0, X, 0)
    for dq in np.diff(q):
        F = step_row(P, 0, X, 0, dq, 1.0, dq)
        commit(P, 0, X, 0)
        yield F, X


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.9, 0.9999), st.integers(30, 150))
def test_what_is_given_up_costs_less_than_stated(seed, shrink, reversals):
    """Any spiral in and out again, with some noise: within the bound of the full memory."""
    rng = np.random.default_rng(seed)
    turns = 1.4e-5 * shrink ** np.arange(reversals) * (-1.0) ** np.arange(reversals)
    turns *= rng.uniform(0.9, 1.0, reversals)
    q = np.concatenate(([0.0], turns, -turns[::-1]))
    wanted, _ = reference_torque(LAW, np.arange(len(q)) * 1.0, q)
    for (got, X), F in zip(stepped(q), wanted[1:], strict=True):
        assert abs(got - F) <= min(X[m.BOUND], 0.2 * LAW.Fs_pos) + 1e-5


def test_a_simulated_joint_tells_what_it_remembers_and_what_it_gave_up():
    """It is led along a shrinking spiral."""
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": LAW})
    data, found = mujoco.MjData(model := spec.compile()), []
    q = [0.0, *(1.4e-5 * 0.97**i * (-1.0) ** i for i in range(1, 100))]
    with fj.attach(model):
        for i, data.qpos[0] in enumerate(q):
            data.time = i * model.opt.timestep
            mujoco.mj_forward(model, data)
            found.append(fj.remembered(model, data)["j"])
    assert (found[0].minima, found[0].maxima, found[0].forgotten, found[0].error) == (0, 0, 0, 0.0)
    few, many = found[12], found[-1]
    # a call commits the one before: eleven moves are known at the twelfth
    *_, (_, X) = stepped(q[:12])
    assert (few.minima, few.maxima) == (X[m.N_MIN] - 1, X[m.N_MAX] - 1)
    assert few.minima + few.maxima >= 6
    assert few.forgotten == 0 < many.forgotten
    assert 0.0 < many.error <= LAW.Fs_pos + LAW.Fs_neg
    assert max(many.minima, many.maxima) < m.CAPACITY
    errors = [x.error for x in found]
    assert errors == sorted(errors)
