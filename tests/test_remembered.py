"""What a simulated joint tells of its memory."""

import mujoco
import numpy as np
from test_memory import LAW

import frictionjoint as fj
from frictionjoint.law import memory as m
from frictionjoint.law.kernel import commit, row_size, start_row, step_row

JOINT = """<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body>
<joint name="j"/><geom size="0.1" mass="1"/></body></worldbody></mujoco>"""


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
    P = LAW.pack()
    X = np.zeros(row_size(P, 0))
    start_row(P, 0, X, 0)
    # a call commits the one before: eleven moves are known at the twelfth
    for dq in np.diff(q[:12]):
        step_row(P, 0, X, 0, dq, 1.0, dq)
        commit(P, 0, X, 0)
    assert (few.minima, few.maxima) == (X[m.N_MIN] - 1, X[m.N_MAX] - 1)
    assert few.minima + few.maxima >= 6
    assert few.forgotten == 0 < many.forgotten
    assert 0.0 < many.error <= LAW.Fs_pos + LAW.Fs_neg
    assert max(many.minima, many.maxima) < m.CAPACITY
    errors = [x.error for x in found]
    assert errors == sorted(errors)
