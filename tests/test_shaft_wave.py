"""A shaft's friction level that rises and falls with its turn: in MuJoCo, a file, an export."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ModelError
from frictionjoint.export.run import export
from frictionjoint.simulate.shaft_wave import SHAFT_TAG, add_wave

FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
WAVE = {"ratio": -2.0, "waves": 32.0, "sin": 0.2, "cos": -0.1, "turns_over": 0.1}
ARM = """
<mujoco><worldbody>
  <body><joint name="a" axis="0 0 1" armature="1"/><geom size=".1"/>
    <body pos=".3 0 0"><joint name="b" axis="0 0 1" armature="1"/><geom size=".1"/></body>
  </body></worldbody>
  <tendon><fixed name="shaft" frictionloss=".5">
    <joint joint="a" coef="1"/><joint joint="b" coef="-2"/></fixed></tendon>
</mujoco>
"""


def spec(wave: bool = True) -> mujoco.MjSpec:
    """Friction in one joint, and a shaft of both."""
    made = mujoco.MjSpec.from_string(ARM)
    fj.install(made, {"a": FRICTION})
    if wave:
        add_wave(made, "shaft", **WAVE)
    return made


def passive(made: mujoco.MjSpec, backend: str, q, v) -> np.ndarray:
    """Passive torque of all joints."""
    model = mujoco.MjModel.from_xml_string(made.to_xml())
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = q, v
    with fj.attach(model, backend):
        mujoco.mj_forward(model, data)
    return data.qfrc_passive.copy()


@pytest.mark.parametrize("backend", ["native", "python"])
def test_both_joints_bear_it(backend):
    rng = np.random.default_rng(3)
    for _ in range(5):
        q, v = rng.uniform(-1.0, 1.0, (2, 2))
        plain = passive(spec(False), backend, q, v)
        turn, speed = q[0] - 2.0 * q[1], v[0] - 2.0 * v[1]
        level = 0.2 * np.sin(32.0 * turn) - 0.1 * np.cos(32.0 * turn)
        torque = level * np.tanh(speed / 0.1)
        found = passive(spec(), backend, q, v) - plain
        assert found == pytest.approx([-torque, 2.0 * torque], abs=1e-12)


def test_a_model_that_is_attached_to_another_has_it_by_its_new_names():
    parent, child = mujoco.MjSpec(), spec()
    parent.nuserdata = child.nuserdata
    parent.worldbody.add_frame().attach_body(child.worldbody.first_body(), "left-", "")
    q, v = [0.2, -0.4], [1.0, 0.3]
    alone = passive(spec(), "native", q, v)
    assert passive(parent, "native", q, v) == pytest.approx(alone, abs=1e-9)
    assert any(n.name.startswith("left-" + SHAFT_TAG) for n in parent.numerics)


def test_a_wave_without_its_tendon_is_refused_in_one_line():
    made = spec(False)
    add_wave(made, "rod", **WAVE)
    with pytest.raises(ModelError, match="names tendon 'rod': the model has shaft"):
        fj.attach(made.compile())


@pytest.mark.parametrize("target", ["native", "c"])
def test_an_export_says_that_it_is_lost(tmp_path, target):
    path = tmp_path / "arm.xml"
    path.write_text(spec().to_xml())
    done = export(path, target, tmp_path / "out")
    assert "shaft: the wave of 0.224 N m in its friction level" in done.lost
    assert SHAFT_TAG not in done.text
