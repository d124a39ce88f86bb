"""What friction adds to MuJoCo's mass matrix is there once, however often MuJoCo calls back."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from tests.standing import LINKAGE, table, with_friction

POSITION = int(mujoco.mjtStage.mjSTAGE_POS)
NOTHING = int(mujoco.mjtStage.mjSTAGE_NONE)
MODELS = {"linkage": LINKAGE, "table": table()}


def stirred(model, steps=60):
    """Data after a few steps under loads that make some joints slip."""
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    for _ in range(steps):
        data.qfrc_applied[:] = rng.normal(size=model.nv)
        mujoco.mj_step(model, data)
    return data


def make(name, ratio, solver="Newton"):
    model = with_friction(MODELS[name], 0.5 if name == "linkage" else 4.0, ratio, 0.3)
    model.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver.upper()}")
    return model


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("ratio", [0.3, 5.0])
@pytest.mark.parametrize("solver", ["Newton", "PGS"])
@pytest.mark.parametrize("backend", ["native", "python"])
def test_repeated_evaluations_of_one_position_are_the_same_to_the_bit(name, ratio, solver, backend):
    model = make(name, ratio, solver)
    # else each evaluation would begin from the solution of the last one
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_WARMSTART)
    with fj.attach(model, backend):
        data = stirred(model)
        mujoco.mj_forward(model, data)
        first = [data.M.copy(), data.qLD.copy(), data.qacc.copy(), data.userdata.copy()]
        used = data.parena
        for skipped in (POSITION, POSITION, NOTHING, POSITION):
            mujoco.mj_forwardSkip(model, data, skipped, 0)
            again = [data.M, data.qLD, data.qacc, data.userdata]
            for one, other in zip(first, again, strict=True):
                np.testing.assert_array_equal(one, other)
            assert data.parena == used, "each evaluation takes more of the arena"
    assert np.abs(data.M - plain_of(model, data)).max() > 1e-6


def plain_of(model, data):
    """M in MuJoCo's sparse format, without friction."""
    plain = mujoco.MjData(model)
    plain.qpos[:] = data.qpos
    mujoco.mj_fwdPosition(model, plain)
    return plain.M


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("ratio", [0.3, 5.0])
def test_inverse_dynamics_give_back_what_was_applied(name, ratio):
    model = make(name, ratio)
    with fj.attach(model):
        data = stirred(model)
        mujoco.mj_forward(model, data)
        for _ in range(2):
            mujoco.mj_inverse(model, data)
            # constraint forces of the inverse are those of the forward solution to its tolerance
            np.testing.assert_allclose(data.qfrc_inverse, data.qfrc_applied, atol=2e-4)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("ratio", [0.3, 5.0])
def test_derivatives_are_those_of_whole_steps(name, ratio):
    model = make(name, ratio)
    model.opt.tolerance = 0.0
    n, eps, kind = 2 * model.nv, 1e-6, mujoco.mjtState.mjSTATE_INTEGRATION
    with fj.attach(model):
        data = stirred(model)
        state = np.zeros(mujoco.mj_stateSize(model, kind))
        mujoco.mj_getState(model, data, state, kind)

        def stepped(i, shift):
            probe, way = mujoco.MjData(model), np.zeros(model.nv)
            mujoco.mj_setState(model, probe, state, kind)
            if i < model.nv:
                way[i] = shift
                mujoco.mj_integratePos(model, probe.qpos, way, 1.0)
            else:
                probe.qvel[i - model.nv] += shift
            mujoco.mj_step(model, probe)
            return probe

        whole = np.zeros((n, n))
        for i in range(n):
            ahead, behind = stepped(i, eps), stepped(i, -eps)
            moved = np.zeros(model.nv)
            mujoco.mj_differentiatePos(model, moved, 2.0 * eps, behind.qpos, ahead.qpos)
            whole[:, i] = [*moved, *((ahead.qvel - behind.qvel) / (2.0 * eps))]
        A = np.zeros((n, n))
        mujoco.mjd_transitionFD(model, data, eps, True, A, None, None, None)
        np.testing.assert_allclose(A, whole, rtol=1e-6, atol=1e-6 * np.abs(whole).max())


def test_the_matrix_is_plain_without_friction_and_in_an_explicit_step():
    model = make("linkage", 5.0)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with fj.attach(model):
        data = stirred(model, 20)
        mujoco.mj_forward(model, data)
        np.testing.assert_array_equal(data.M, plain_of(model, data))
