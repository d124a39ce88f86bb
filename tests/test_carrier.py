"""A model carries its friction: exact through XML, prefixes and copies; mistakes get one line."""

import copy
import warnings

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import frictionjoint as fj
from frictionjoint.effects.position import POSITION_PERIODIC as EFFECT
from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.carrier import read_friction

XML = """
<mujoco>
  <worldbody>
    <body name="link"><joint name="{name}" type="{kind}"/><geom size=".1"/></body>
  </worldbody>
</mujoco>
"""
KNOTS = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))


def friction(**changes) -> fj.FrictionParameters:
    values = dict(Fs=1.5, Fc=1.0 / 3.0, Vs=0.0123456789, knots=KNOTS) | changes
    return fj.FrictionParameters.symmetric(**values)


def carrying(parameters, effects=()) -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_string(XML.format(name="elbow", kind="hinge"))
    fj.install(spec, {"elbow": parameters}, {"elbow": list(effects)})
    return spec


@given(
    Fc=st.floats(1e-9, 1.5),
    Vs=st.floats(1e-9, 1e9),
    n=st.floats(1, 1000),
    sigma1=st.floats(0, 1e11),
)
def test_round_trip_through_xml_is_exact(Fc, Vs, n, sigma1):
    parameters = friction(Fc=Fc, Vs=Vs, n=n, sigma1=sigma1)
    effect = SimulatedEffect(EFFECT, (Vs,), (Fc, -sigma1))
    text = carrying(parameters, [effect]).to_xml()
    carried = read_friction(mujoco.MjModel.from_xml_string(text))["elbow"]
    assert carried.parameters == parameters
    assert carried.effects == (effect,)


def test_an_effect_with_too_few_numbers_is_refused():
    with pytest.raises(ParameterError, match=f"effect {EFFECT.name}: 0 numbers as shape, it has 1"):
        SimulatedEffect(EFFECT, (), (0.1, 0.2))


def test_a_number_beside_which_mujoco_would_lose_others_is_refused():
    with pytest.raises(ModelError, match=r"'elbow' has a parameter of 2e\+12.*below 1e\+11"):
        carrying(friction(Fc=1.0, Vs=1.0, n=1.0, sigma1=2e12), [])


def test_a_model_with_too_little_userdata_gets_room_behind_its_own():
    spec = carrying(friction())
    need, spec.nuserdata = spec.nuserdata, 5
    model = spec.compile()
    with fj.attach(model):
        assert model.nuserdata == 5 + need
        data = mujoco.MjData(model)
        data.userdata[:5] = 7.0
        data.qfrc_applied[0] = 0.5
        mujoco.mj_step(model, data, nstep=20)
        assert fj.torque(model, data)["elbow"].hysteresis > 0.0
        mujoco.mj_step(model, copied := copy.copy(data))
        assert copied.time > data.time
    assert list(data.userdata[:5]) == [7.0] * 5


@pytest.mark.parametrize("backend", ["native", "python"])
def test_data_made_before_their_model_got_room_are_left_alone_with_one_warning(backend):
    spec = carrying(friction())
    spec.nuserdata = 0
    model = spec.compile()
    early, free = mujoco.MjData(model), mujoco.MjData(model)
    mujoco.mj_step(model, free, nstep=50)
    with fj.attach(model, backend):
        with pytest.warns(RuntimeWarning, match=r"create it after frictionjoint\.attach") as told:
            mujoco.mj_step(model, early, nstep=50)
        assert len(told) == 1
        np.testing.assert_array_equal(early.qpos, free.qpos)
        mujoco.mj_resetData(model, early)
        with pytest.raises(ModelError, match="0 numbers of userdata, the model"):
            fj.torque(model, early)


def test_friction_comes_with_attach_in_an_mjcf(tmp_path):
    (tmp_path / "arm.xml").write_text(carrying(friction()).to_xml())
    (tmp_path / "cell.xml").write_text(
        '<mujoco><asset><model name="arm" file="arm.xml"/></asset><worldbody>'
        '<attach model="arm" body="link" prefix="R_"/></worldbody></mujoco>'
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # MuJoCo's, about the child's user data
        model = fj.load_model(tmp_path / "cell.xml")
    data = mujoco.MjData(model)
    with fj.attach(model):
        mujoco.mj_step(model, data)
    assert fj.torque(model, data)["R_elbow"].time == 0.0


@pytest.mark.parametrize(
    ("name", "kind", "joint", "words"),
    [
        ("elbow", "hinge", "knee", "no joint 'knee': the model has elbow"),
        ("elbow", "ball", "elbow", "is a ball joint"),
        ("elbow", "free", "elbow", "is a free joint"),
    ],
)
def test_unfit_joints_are_refused_by_name(name, kind, joint, words):
    spec = mujoco.MjSpec.from_string(XML.format(name=name, kind=kind))
    with pytest.raises(ModelError, match=words):
        fj.install(spec, {joint: friction()})
    assert not list(spec.numerics)


def test_model_without_friction_is_refused(tmp_path):
    (tmp_path / "bare.xml").write_text(XML.format(name="elbow", kind="hinge"))
    with pytest.raises(ModelError, match="has no friction"):
        fj.load_model(tmp_path / "bare.xml")


def test_a_deleted_joint_whose_friction_stayed_is_named_with_the_fix():
    spec = mujoco.MjSpec.from_string(XML.format(name="elbow", kind="hinge"))
    spec.worldbody.add_body(pos=[1, 0, 0]).add_joint(name="knee")
    spec.bodies[-1].add_geom(size=[0.1, 0, 0])
    fj.install(spec, {"elbow": friction(), "knee": friction()})
    spec.delete(spec.joint("knee").parent)
    with pytest.raises(
        ModelError, match=r"'knee', which the model lacks .*delete that numeric too"
    ):
        fj.attach(spec.compile())
    spec.delete(next(n for n in spec.numerics if n.name.endswith("knee")))
    with fj.attach(spec.compile()) as m:
        assert list(fj.torque(m, mujoco.MjData(m))) == ["elbow"]


def two_joints() -> str:
    """An MJCF of joints a and b."""
    spec = mujoco.MjSpec.from_string(
        "<mujoco><worldbody><body><joint name='a'/><geom size='.1'/><body><joint name='b'/>"
        "<geom size='.1'/></body></body></worldbody></mujoco>"
    )
    fj.install(spec, {"a": friction(Vs=0.1 / 3.0), "b": friction(Vs=0.2 / 3.0)})
    return spec.to_xml()


def test_blocks_of_a_model_lie_together_once_it_is_attached():
    model = mujoco.MjModel.from_xml_string(two_joints())
    with fj.attach(model):
        sizes = model.numeric_size.copy()
    assert model.numeric_adr[1] == model.numeric_adr[0] + sizes[0]
    for one in (model, copy.copy(model)):
        found = read_friction(one)
        assert found["a"].parameters == friction(Vs=0.1 / 3.0)
        assert found["b"].parameters == friction(Vs=0.2 / 3.0)


def test_numbers_changed_by_hand_or_in_a_compiled_model_count(tmp_path):
    text = two_joints()
    assert text.count("0.0333333") == 2  # both directions
    model = mujoco.MjModel.from_xml_string(text.replace("0.0333333", "0.03"))
    assert read_friction(model)["a"].parameters == friction(Vs=0.03)
    assert read_friction(model)["b"].parameters == friction(Vs=0.2 / 3.0)
    fj.attach(mujoco.MjModel.from_xml_string(text)).detach()
    model = mujoco.MjModel.from_xml_string(text)
    with fj.attach(model):
        fj.set_parameters(model, "b", friction(Vs=0.7 / 3.0))
        mujoco.mj_saveLastXML(str(tmp_path / "saved.xml"), model)
    saved = read_friction(fj.load_model(tmp_path / "saved.xml"))
    assert saved["a"].parameters == friction(Vs=0.1 / 3.0)
    np.testing.assert_allclose(
        saved["b"].parameters.pack(), friction(Vs=0.7 / 3.0).pack(), rtol=1e-5
    )


@pytest.mark.parametrize("own", [100, 1000])
def test_a_parent_with_many_user_data_keeps_them_all(own):
    parent = mujoco.MjSpec()
    parent.nuserdata = own
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # MuJoCo's, about the child's user data
        parent.attach(carrying(friction()), prefix="L_", frame=parent.worldbody.add_frame())
    model = parent.compile()
    with fj.attach(model):
        room = model.nuserdata
        data = mujoco.MjData(model)
        data.userdata[:own] = 7.0
        data.qfrc_applied[0] = 0.5
        mujoco.mj_step(model, data, nstep=20)
        assert fj.torque(model, data)["L_elbow"].hysteresis > 0.0
        assert read_friction(model)["L_elbow"].parameters == friction()
        assert model.nuserdata == room, "it gets room once"
    np.testing.assert_array_equal(data.userdata[:own], 7.0)
    fj.uninstall(parent)
    assert parent.nuserdata == own
