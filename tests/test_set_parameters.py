"""Friction of a compiled model is changed in place, and states start afresh when asked to."""

import json

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import frictionjoint as fj
from frictionjoint.effects.rigid_body import SPRING, TORQUE_BIAS
from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.files import read_samples, toml_document
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.rivals import LuGreParameters
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.set_parameters import FrictionSamples

KNOTS = ((1e-3, 1.5), (1e-2, 3.2))
TWO = """<mujoco><option timestep="0.001"/><worldbody>
<body><joint name="a" armature="1"/><geom size=".1"/></body>
<body><joint name="b" armature="1"/><geom size=".1"/></body></worldbody></mujoco>"""


def law(Fs: float) -> fj.FrictionParameters:
    return fj.FrictionParameters.symmetric(Fs=Fs, Fc=0.7 * Fs, Vs=0.05, n=2, knots=KNOTS)


def bias(torque: float) -> SimulatedEffect:
    return SimulatedEffect(TORQUE_BIAS, (), (torque,))


def model(Fs: float = 1.0, torque: float = 0.2) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(TWO)
    fj.install(spec, {"a": law(Fs), "b": law(1.0)}, {"a": [bias(torque)]})
    return spec.compile()


def path(m: mujoco.MjModel, steps: int = 200) -> np.ndarray:
    data = mujoco.MjData(m)
    positions = []
    with fj.attach(m):
        for k in range(steps):
            data.qfrc_applied[:] = 1.8 * np.sin(0.05 * k)
            mujoco.mj_step(m, data)
            positions.append(data.qpos.copy())
    return np.array(positions)


def test_a_changed_joint_moves_as_one_that_was_compiled_so():
    changed = model(1.0, 0.2)
    before = path(changed)
    fj.set_parameters(changed, "a", JointFriction(law(1.5), (bias(-0.1),)))
    after = path(changed)
    np.testing.assert_array_equal(after, path(model(1.5, -0.1)))
    assert np.abs(after[:, 0] - before[:, 0]).max() > 1e-4
    np.testing.assert_allclose(after[:, 1], before[:, 1], rtol=1e-9, atol=1e-12)
    assert read_friction(changed)["a"].effects[0].coefficients == (-0.1,)


@pytest.mark.parametrize(
    ("joint", "parameters", "words"),
    [
        ("c", law(1.0), "joint 'c' has no friction: choose from a, b"),
        ("a", LuGreParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma0=300.0), "keep law"),
        (
            "a",
            JointFriction(law(1.0), (SimulatedEffect(SPRING, (), (1.0, 0.0)),)),
            "has the effects torque-bias, not spring",
        ),
    ],
)
def test_what_does_not_fit_is_refused_and_changes_nothing(joint, parameters, words):
    m = model()
    before = read_friction(m)
    with pytest.raises(ModelError, match=words):
        fj.set_parameters(m, joint, parameters)
    fj.set_parameters(m, "b", law(1.0))
    assert read_friction(m) == before
    with pytest.raises(TypeError, match="is not a set of friction parameters"):
        fj.set_parameters(m, "a", {"Fs_pos": 1.0})


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_joint_whose_friction_changes_while_it_moves_obeys_the_new_one(seed):
    """And as soon as it slides, nothing of the old one is left."""
    random = np.random.default_rng(seed)
    m, fresh = model(1.0, 0.0), model(1.0, 0.0)
    data, other = mujoco.MjData(m), mujoco.MjData(fresh)
    data.qpos[0] = random.normal()
    with fj.attach(m):
        for _ in range(int(random.integers(1, 5))):
            level = float(10.0 ** random.uniform(-1.0, 0.2))
            fj.set_parameters(m, "a", law(level))
            for x in np.cumsum(random.normal(size=20)) * 10.0 ** random.uniform(-5.0, -2.0):
                data.qpos[0], data.time = x, data.time + 1e-3
                mujoco.mj_forward(m, data)
                assert abs(fj.torque(m, data)["a"].hysteresis) <= level * (1.0 + 1e-12)
        fj.set_parameters(fresh, "a", law(level))
        way = random.choice([-1.0, 1.0])
        for x in np.linspace(data.qpos[0], data.qpos[0] + 0.5 * way, 1000):
            for each, of in ((m, data), (fresh, other)):
                of.qpos[0], of.time = x, of.time + 1e-3
                mujoco.mj_forward(each, of)
        last = [fj.torque(each, of)["a"] for each, of in ((m, data), (fresh, other))]
    assert last[0].hysteresis == pytest.approx(last[1].hysteresis, rel=1e-9)
    assert abs(last[0].hysteresis) > 0.6 * level


def test_a_teleported_joint_that_forgets_feels_no_torque():
    m = model(torque=0.0)
    data = mujoco.MjData(m)
    with fj.attach(m):
        mujoco.mj_step(m, data, 5)
        data.qpos[:] = 0.5
        mujoco.mj_forward(m, data)
        assert fj.torque(m, data)["a"].hysteresis > 0.5, "a jump loads the bristles"
        fj.forget(m, data)
        mujoco.mj_forward(m, data)
        assert fj.torque(m, data)["a"].hysteresis == 0.0
        mujoco.mj_step(m, data, 50)
        np.testing.assert_allclose(data.qpos, 0.5, atol=1e-9)


def test_one_joint_may_forget_alone_and_the_users_data_stay():
    spec = mujoco.MjSpec.from_string(TWO)
    spec.nuserdata = 2
    fj.install(spec, {"a": law(1.0), "b": law(1.0)})
    m = spec.compile()
    data = mujoco.MjData(m)
    data.userdata[:2] = 7.0
    with fj.attach(m):
        data.qfrc_applied[:] = 0.5
        mujoco.mj_step(m, data, 50)
        held = fj.torque(m, data)["b"].hysteresis
        fj.forget(m, data, "a")
        found = fj.torque(m, data)
    assert found["a"].hysteresis == 0.0
    assert found["b"].hysteresis == held != 0.0
    np.testing.assert_array_equal(data.userdata[:2], 7.0)
    with pytest.raises(ModelError, match="joint 'c' has no friction"):
        fj.forget(m, data, "c")


@pytest.mark.parametrize("act", [fj.torque, fj.forget, fj.remembered])
def test_data_of_another_model_are_refused(act):
    m, other = model(), mujoco.MjModel.from_xml_string(TWO)
    with pytest.raises(ModelError, match=r"give the data of this model, made by mujoco\.MjData"):
        act(m, mujoco.MjData(other))
    with pytest.raises(ModelError, match=r"give the data of this model"):
        act(m, mujoco.MjData(mujoco.MjModel.from_xml_string("<mujoco/>")))


def test_samples_are_read_from_the_file_that_the_command_writes(tmp_path):
    drawn = [JointFriction(law(Fs), (bias(0.1 * Fs),)) for Fs in (0.8, 1.0, 1.2)]
    tables = [toml_document(x.parameters, x.effects).unwrap() for x in drawn]
    file = tmp_path / "samples.json"
    file.write_text(json.dumps(tables))
    assert list(read_samples(file)) == drawn
    m = model()
    number = FrictionSamples({"a": file}).draw(m, np.random.default_rng(3))["a"]
    assert read_friction(m)["a"] == drawn[number]
    file.write_text("[{}]")
    with pytest.raises(ParameterError, match="sample 0: "):
        read_samples(file)
    file.write_text("{}")
    with pytest.raises(ParameterError, match="no list of tables"):
        read_samples(file)
    with pytest.raises(ModelError, match="joint 'a' has no samples"):
        FrictionSamples({"a": []})
