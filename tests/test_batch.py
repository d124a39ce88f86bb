"""A thousand simulations at once: MuJoCo's Batch, each joint with a friction of its own."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ModelError
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.set_parameters import write_parameters

Batch = pytest.importorskip("mujoco.batch", reason="MuJoCo before 3.17 has no Batch").Batch
MANY = 1024
STEPS = 150
KNOTS = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 4.2))
ARM = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody><body><joint name="a" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/></body></worldbody>
  <actuator><motor joint="a"/></actuator>
</mujoco>
"""


def friction(Fs: float) -> fj.FrictionParameters:
    return fj.FrictionParameters.symmetric(
        Fs=Fs, Fc=0.7 * Fs, Vs=0.01, sigma2=0.4, sigma1=0.5, n=2, knots=KNOTS
    )


def model(Fs: float = 1.0) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"a": friction(Fs)})
    return spec.compile()


def push(k: int) -> float:
    return 1.6 * np.sin(0.04 * k) + 0.5 * np.sin(0.23 * k)


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_a_thousand_joints_equal_loops_of_their_own(threads):
    levels = np.random.default_rng(7).uniform(0.4, 1.9, MANY)
    m = model()
    with fj.attach(m):
        batch = Batch(m, MANY, threads)
        rows = batch.expand("numeric_data")
        for row, Fs in zip(rows, levels, strict=True):
            write_parameters(row, blocks(m)["a"], friction(Fs), "a")
        control, position = batch.bind("ctrl"), batch.bind("qpos")
        for k in range(STEPS):
            control[:] = push(k)
            batch.step()
    for i in range(0, MANY, 173):
        alone = model(levels[i])
        with fj.attach(alone):
            data = mujoco.MjData(alone)
            for k in range(STEPS):
                data.ctrl[:] = push(k)
                mujoco.mj_step(alone, data)
        np.testing.assert_array_equal(position[i], data.qpos)
    assert np.ptp(position) > 10 * KNOTS[-1][0], "none broke away: the test would prove little"


def test_another_number_of_knots_needs_compiling():
    m = model()
    before = m.numeric_data.copy()
    fewer = fj.FrictionParameters.symmetric(Fs=1.0, Fc=0.7, Vs=0.01, knots=KNOTS[:2])
    with pytest.raises(ModelError, match="install and compile"):
        write_parameters(m.numeric_data, blocks(m)["a"], fewer, "a")
    np.testing.assert_array_equal(m.numeric_data, before)
