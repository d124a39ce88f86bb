"""Stick-slip of the KUKA joint beside an integration of motion and law as one equation."""

import mujoco
import numpy as np
import pytest
from driven import driven

import frictionjoint as fj
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.stick_slip import JOINT, SPEED, kuka_model


def between_stops(q, v):
    """Distance from each stop to the next, rad; the first from where the joint was at first."""
    stops, k = [0.0], 0
    while (v[k:] > 0.02).any():
        k += int(np.argmax(v[k:] > 0.02))
        if not (v[k:] <= 0.0).any():
            break
        k += int(np.argmax(v[k:] <= 0.0))
        stops.append(q[k - 2 : k + 3].max())
    return np.diff(stops)


@pytest.fixture(scope="module")
def exact():
    """Position and velocity every millisecond, by an integration of its own."""
    model = fj.load_model(kuka_model())
    law = read_friction(model)[JOINT].parameters
    kp, most = model.actuator_gainprm[0, 0], model.actuator_forcerange[0, 1]
    J = 1.0 / model.dof_invweight0[0]
    time = np.arange(5001) * 1e-3
    return driven(law, J, lambda t, q: np.clip(kp * (SPEED * t - q), -most, most), time)


@pytest.mark.parametrize(("every", "limit"), [(1, 3e-5), (2, 5.5e-5)])
def test_slips_are_those_of_an_exact_integration(exact, every, limit):
    q, v = exact[:, ::every]
    wanted = between_stops(q, v)
    model = fj.load_model(kuka_model())
    model.opt.timestep = 1e-3 * every
    data, found = mujoco.MjData(model), np.zeros((2, len(q)))
    with fj.attach(model):
        for k in range(1, len(q)):
            data.ctrl[0] = SPEED * data.time
            mujoco.mj_step(model, data)
            found[:, k] = data.qpos[0], data.qvel[0]
    slips = between_stops(*found)
    assert len(slips) == len(wanted) >= 4
    np.testing.assert_allclose(slips, wanted, rtol=0.0, atol=limit)
