"""A model that an earlier run wrote is one to start from: its friction is left out, and said so."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects.gear import JOINT_ELASTICITY
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.motor import Motor, add_motor
from frictionjoint.simulate.uninstall import carrying

FRICTION = fj.FrictionParameters.symmetric(
    Fs=0.6, Fc=0.4, Vs=0.1, sigma2=0.3, n=2, knots=((1e-3, 0.4), (1e-2, 1.2))
)
ARM = """
<mujoco>
  <size nuserdata="3"/>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/>
      <body pos="0 0 -.4"><joint name="b" axis="0 1 0" armature="0.002"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/></body></body>
  </worldbody>
</mujoco>"""
ELASTIC = SimulatedEffect(JOINT_ELASTICITY, (30.0, 0.05), (0.004,))


def earlier(effects=()) -> str:
    """The arm as a run left it: friction on both joints, effects and a motor on the second."""
    spec = mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"a": FRICTION, "b": FRICTION}, {"b": effects})
    add_motor(spec, "b", Motor(0.2, 0.01))
    spec.compile()
    return spec.to_xml()


@pytest.mark.parametrize("effects", [(), (ELASTIC,)])
def test_its_rigid_body_is_that_of_the_model_before(effects):
    body, plain = RigidBody(earlier(effects), "b"), RigidBody(ARM, "b")
    assert body.carried
    assert not plain.carried
    assert body.model.nv == plain.model.nv
    t = np.linspace(0.0, 1.0, 50)
    motion = np.sin(3.0 * t), 3.0 * np.cos(3.0 * t), -9.0 * np.sin(3.0 * t)
    found, known = body.torque(*motion).load, plain.torque(*motion).load
    np.testing.assert_allclose(found, known, rtol=1e-5, atol=1e-6)


def test_the_report_says_that_it_is_left_out():
    (said,) = Bodies(earlier(), "b").check([], [])
    assert said.startswith(
        "The model contains friction at joint b from an earlier run: it is ignored"
    )
    assert not Bodies(ARM, "b").check([], [])


def test_it_takes_friction_and_a_motor_again_and_other_joints_keep_theirs():
    spec = RigidBody(earlier(), "b").spec()
    assert carrying(spec) == ["a"]
    fj.install(spec, {"b": FRICTION})
    add_motor(spec, "b", Motor(0.3, 0.01))
    model = spec.compile()
    assert model.actuator_gainprm[:, 0] == pytest.approx([0.3])
    with fj.attach(model):
        mujoco.mj_step(model, mujoco.MjData(model))
