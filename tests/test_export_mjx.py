"""`export --to mjx`: what MJX refuses or passes over is left out, and named."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from exported import carrying

import frictionjoint as fj
from frictionjoint.export.mjx import fit_for_mjx
from frictionjoint.export.run import export

LAW = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.4, knots=((1e-3, 1.0), (3e-3, 2.0), (2e-2, 3.0))
)
ARM = """<mujoco><option integrator="implicit" solver="PGS"><flag energy="enable"/></option>
<worldbody><body name="arm"><joint name="elbow" axis="0 1 0" range="-300 300"/>
<geom size="0.05" pos="0 0 -0.2"/>
<geom name="tip" size="0.02" pos="0 0 -0.4"/></body>
<body name="ball" pos="1 0 0"><freejoint/><geom name="ball" size="0.05"/></body></worldbody>
<equality><connect name="kept" body1="ball" anchor="0 0 0"/></equality>
<actuator><motor name="kept" joint="elbow"/>
<general name="own" joint="elbow" gaintype="user" biastype="user" dyntype="none"/></actuator>
<sensor><jointpos name="kept" joint="elbow"/><jointlimitpos name="limit" joint="elbow"/>
<actuatorfrc name="of own" actuator="own"/></sensor></mujoco>"""


def test_what_is_refused_is_left_out_and_named(tmp_path: Path) -> None:
    path = carrying(ARM, LAW, tmp_path)
    done = export(path, "mjx", tmp_path / "mjx.xml")
    model = mujoco.MjModel.from_xml_string(done.text)
    assert [model.actuator(i).name for i in range(model.nu)] == ["kept"]
    assert [model.sensor(i).name for i in range(model.nsensor)] == ["kept"]
    assert model.neq == 1
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert model.opt.solver == mujoco.mjtSolver.mjSOL_NEWTON
    said = " ".join(done.lost)
    parts = "integrator implicit", "solver PGS", "flag energy", "'own'", "'limit'", "presliding"
    assert [part for part in parts if part not in said] == []
    assert fit_for_mjx(mujoco.MjSpec.from_string(done.text)) == []
    # damping is one number, and Coulomb friction is there
    assert model.dof_frictionloss[0] > 0.5
    assert model.dof_damping[0] > 0.0
    np.testing.assert_array_equal(np.ravel(getattr(model, "dof_dampingpoly", 0.0)), 0.0)


def test_mjx_loads_it_and_agrees(tmp_path: Path) -> None:
    jax = pytest.importorskip("jax")
    mjx = pytest.importorskip("mujoco.mjx")
    path = carrying(ARM, LAW, tmp_path)
    with pytest.raises(NotImplementedError):
        mjx.put_model(mujoco.MjModel.from_xml_path(str(path)))
    model = mujoco.MjModel.from_xml_string(export(path, "mjx", tmp_path / "mjx.xml").text)
    model.opt.iterations = 50
    data, loaded = mujoco.MjData(model), mjx.put_model(model)
    data.qvel[0] = 3.0
    there, step = mjx.put_data(model, data), jax.jit(mjx.step)
    for _ in range(50):
        mujoco.mj_step(model, data)
        there = step(loaded, there)
    np.testing.assert_allclose(there.qpos[0], data.qpos[0], rtol=0.02)
