"""The numbers exported for Newton, in Newton: its own builder takes them, its solver slides.

It asks for an environment of its own, Python 3.12 and `newton[sim]` 1.8.0; elsewhere it is skipped.
"""

import mujoco
import numpy as np
import pytest
from exported import carrying, module_of

import frictionjoint as fj
from frictionjoint.export.run import export

newton = pytest.importorskip("newton", reason="Newton is not installed")
pytest.importorskip("mujoco_warp", reason="Newton's solver needs newton[sim]")

STEP, FORCE = 0.001, 2.5
LAW = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.4, n=2.0, knots=((2e-3, 1.5), (8e-3, 3.0))
)
ARM = f"""<mujoco model="arm"><compiler angle="radian"/>
<option timestep="{STEP}" integrator="implicitfast" gravity="0 0 0"/><worldbody>
<body name="link"><joint name="elbow" axis="0 0 1" armature="0.05"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/>
<geom type="sphere" size="0.02" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The robot without friction, what the export defines, and MuJoCo's own export."""
    folder = tmp_path_factory.mktemp("newton")
    carries = carrying(ARM, LAW, folder)
    module = module_of(carries, "newton", speeds=(0.5, 5.0))
    native = export(carries, "native", folder / "native.xml", speeds=(0.5, 5.0)).text
    bare = folder / "bare.xml"
    bare.write_text(ARM)
    return bare, module, mujoco.MjModel.from_xml_string(native)


def speeds(exported, friction, steps):
    """Speed under a constant torque at each step, rad/s, by Newton's MuJoCo solver."""
    bare, module, _ = exported
    builder = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    builder.add_mjcf(str(bare))
    if friction:
        module["apply"](builder)
    model = builder.finalize(device="cpu")
    solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True)
    state, control = model.state(), model.control()
    found = []
    for torque in steps:
        control.joint_f.fill_(torque)
        solver.step(state, state, control, None, STEP)
        found.append(float(state.joint_qd.numpy()[-1]))
    return np.array(found)


def test_it_holds_and_slides_as_in_mujoco(exported):
    torques = np.r_[np.full(200, 0.5), np.full(300, FORCE)]
    found = speeds(exported, True, torques)
    free = speeds(exported, False, torques)
    model = exported[2]
    data = mujoco.MjData(model)
    expected = []
    for torque in torques:
        data.qfrc_applied[0] = torque
        mujoco.mj_step(model, data)
        expected.append(data.qvel[0])
    assert np.abs(found[:200]).max() < 1e-3  # half the Coulomb torque does not move it
    assert free[199] > 1.0
    np.testing.assert_allclose(found, expected, atol=0.02)
    assert found[-1] > 1.0
