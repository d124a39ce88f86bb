"""The mass matrix that a controller reads after a step is the one without friction."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ModelError
from tests.standing import plain_mass

ARM = """<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody><body><freejoint/>
<geom size=".2"/><body><joint name="a" axis="0 1 0" armature=".02"/>
<geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/>
<body pos="0 0 -.4"><joint name="b" axis="1 0 0"/><geom type="capsule" fromto="0 0 0 0 0 -.3"
size=".03"/><body pos="0 0 -.3"><joint name="ball" type="ball"/><geom size=".05"/></body>
</body></body></body></worldbody></mujoco>"""
STIFF = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma1=0.5, sigma2=100.0, knots=((1e-4, 1.5), (1e-3, 3.2))
)


def test_it_is_that_of_the_bare_model_after_each_step():
    bare, spec = mujoco.MjModel.from_xml_string(ARM), mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"a": STIFF, "b": STIFF})
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[6:] = 0.3
    with fj.attach(model):
        for _ in range(5):
            mujoco.mj_step1(model, data)
            position = data.qpos.copy()
            mujoco.mj_step2(model, data)
            added = data.M[model.M_rowadr[6] + model.M_rownnz[6] - 1]
            there, expected = fj.mass_matrix(model, data), plain_mass(bare, position)
            assert added > 1.1 * expected[6, 6], "friction is in it"
            np.testing.assert_allclose(there, expected, rtol=1e-12, atol=1e-14)
        fj.forget(model, data)
        np.testing.assert_array_equal(fj.mass_matrix(model, data), there)


def test_a_model_without_friction_has_its_own():
    bare = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(bare)
    mujoco.mj_forward(bare, data)
    np.testing.assert_allclose(fj.mass_matrix(bare, data), plain_mass(bare, bare.qpos0), atol=1e-14)
    still = mujoco.MjModel.from_xml_string("<mujoco/>")
    assert fj.mass_matrix(still, mujoco.MjData(still)).shape == (0, 0)
    with pytest.raises(ModelError, match="give the data of this model"):
        fj.mass_matrix(bare, mujoco.MjData(still))
