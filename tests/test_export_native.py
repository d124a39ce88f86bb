"""Exports to plain joints: what they write loads, and loses what they say."""

import dataclasses
import json
import runpy
import sys
import types
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

import frictionjoint as fj
from frictionjoint.cli import app
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import FrictionJointError, LogError, ModelError
from frictionjoint.export.motion import log_motions
from frictionjoint.export.run import export, output_file
from frictionjoint.export.targets import Target
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.rivals import StaticParameters
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.stick_slip import kuka_model

LAW = fj.FrictionParameters(
    **{"Fs_pos": 1.5, "Fs_neg": 1.3, "Fc_pos": 1.5, "Fc_neg": 1.3, "Vs_pos": 0.05, "Vs_neg": 0.05},
    **{"sigma2_pos": 0.4, "sigma2_neg": 0.2},
    knots=((1e-3, 1.0), (3e-3, 2.0), (2e-2, 3.0)),
)
ARM = """<mujoco model="arm"><compiler angle="radian"/>
<option timestep="0.002" integrator="implicitfast"/><size nuserdata="{user}"/>
<worldbody><geom type="plane" size="1 1 1"/><body name="upper" pos="0 0 1" quat="1 0.2 0 0.1">
<joint name="shoulder" axis="0 1 0" pos="0 0 0.05" range="-2 2" limited="true" armature="0.1"/>
<inertial pos="0.1 0 0.02" mass="2" fullinertia="0.02 0.03 0.04 0.001 0.002 0.003"/>
<body name="lower" pos="0.3 0 0"><joint name="turn" axis="1 0 0"/>
<joint name="elbow" axis="0 1 0" pos="0.02 0 0" damping="0.3"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0.3 0 0" mass="1"/>
<body name="tip" pos="0.3 0 0" euler="0.3 0.2 0.1"><geom size="0.02" mass="0.2"/>
<body name="slider" pos="0 0.1 0"><joint name="rail" type="slide" axis="0 0 1" frictionloss="0.2"/>
<geom size="0.01" mass="0.05"/></body></body></body></body></worldbody></mujoco>"""


def effect(name, shape, coefficients):
    found = next(e for e in CATALOGUE if e.name == name)
    return SimulatedEffect(found, shape, coefficients)


EFFECTS = (
    effect("torque-bias", (), (0.3,)),
    effect("spring", (), (2.0, 0.1)),
    effect("inertia-error", (), (0.05,)),
    effect("back-emf", (), (0.25,)),
    effect("position-periodic", (7.0,), (0.1, 0.0)),
)


def arm(folder: Path, friction, effects=None) -> Path:
    spec = mujoco.MjSpec.from_string(ARM.format(user=3))
    install(spec, friction, effects)
    spec.compile()
    path = folder / "arm.xml"
    path.write_text(spec.to_xml())
    return path


@pytest.fixture(scope="module")
def one_joint(tmp_path_factory):
    return arm(tmp_path_factory.mktemp("arm"), {"elbow": LAW}, {"elbow": EFFECTS})


def written(path: Path, target: Target, folder: Path, **more) -> tuple[str, Path]:
    file = output_file(folder, target)
    done = export(path, target, file, **more)
    folder.mkdir(exist_ok=True)
    file.write_text(done.text)
    return done, file


def test_native_has_the_friction_of_steady_sliding(one_joint, tmp_path):
    _, file = written(one_joint, "native", tmp_path / "out", speeds=(0.1, 2.0))
    model = mujoco.MjModel.from_xml_path(str(file))
    assert model.nuserdata == 3  # the user's own
    assert model.nnumeric == 0
    data = mujoco.MjData(model)
    elbow, dof = model.joint("elbow"), model.joint("elbow").dofadr[0]
    assert model.dof_armature[dof] == pytest.approx(0.05)
    model.opt.gravity[:] = 0.0
    bare = mujoco.MjModel.from_xml_string(ARM.format(user=0))
    bare.opt.gravity[:] = 0.0
    reference = mujoco.MjData(bare)
    for v in (0.3, 1.0, -0.5):
        for m, d in ((model, data), (bare, reference)):
            mujoco.mj_resetData(m, d)
            d.qpos[elbow.qposadr[0]], d.qvel[dof] = 0.2, v
            mujoco.mj_inverse(m, d)
        got = (data.qfrc_inverse - reference.qfrc_inverse)[dof]
        level, viscous = (1.5, 0.4) if v > 0.0 else (1.3, 0.2)
        # constant part of the difference between the directions goes along, the rest is its mean
        exact = np.sign(v) * level + (0.25 + viscous) * v + 0.3 + 2.0 * 0.2 + 0.1
        assert got == pytest.approx(exact, abs=0.12)


def test_what_is_lost_is_named(one_joint, tmp_path):
    native, _ = written(one_joint, "native", tmp_path / "a", speeds=(0.1, 2.0))
    urdf, _ = written(one_joint, "urdf", tmp_path / "b", speeds=(0.1, 2.0))
    assert "cogging (sine part 0.1 N m" in native.lost[0]
    assert "spring" not in native.lost[0]
    for word in ("a spring of 2", "a constant torque of", "rotor inertia 0.05"):
        assert word in urdf.lost[0]
    # a plain joint that slides loses little, without spring and bias much
    assert native.losses[0].torque_lost < urdf.losses[0].torque_lost


def test_it_does_not_creep(tmp_path):
    path = arm(tmp_path, {"turn": LAW})
    _, file = written(path, "native", tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.gravity[:] = 0.0
    dof = model.joint("turn").dofadr[0]
    creep = {}
    for name in ("exported", "defaults"):
        if name == "defaults":
            model.dof_solref[dof], model.dof_solimp[dof, :2] = (0.02, 1.0), (0.9, 0.95)
        data = mujoco.MjData(model)
        data.qfrc_applied[dof] = 0.7
        mujoco.mj_step(model, data, 3000)
        creep[name] = data.qvel[dof]
        data.qfrc_applied[dof] = 2.0
        mujoco.mj_step(model, data, 500)
        assert data.qvel[dof] > 0.1  # beyond the limit it goes
    assert 0.0 <= creep["exported"] < 1e-3 * creep["defaults"]


def test_a_law_that_is_a_plain_joint_loses_nothing(tmp_path):
    static = StaticParameters.symmetric(Fs=1.0, Fc=1.0, Vs=0.1, sigma2=0.5, V0=1e-6)
    path = arm(tmp_path, {"turn": static})
    done, _ = written(path, "native", tmp_path / "out", speeds=(0.1, 1.0))
    (loss,) = done.losses
    # all but the 26 of 10,000 samples that rest at a turning point, where a plain joint has any
    # torque: there they are at most two levels of 1 N m apart
    assert loss.torque_lost < 2.0 * np.sqrt(26 / 10_000)


def test_lugre_is_nearer_to_a_law_with_presliding(tmp_path):
    plain, _ = written(kuka_model(), "native", tmp_path / "a")
    lugre, file = written(kuka_model(), "native", tmp_path / "b", lugre=True)
    assert lugre.losses[0].torque_lost < 0.4 * plain.losses[0].torque_lost
    assert lugre.losses[0].apart < 0.3 * plain.losses[0].apart
    model = mujoco.MjModel.from_xml_path(str(file))
    assert model.nu == 1  # it takes no control
    assert model.actuator("joint1_friction").trnid[0] == model.joint("joint1").id
    with pytest.raises(ModelError, match="urdf has no LuGre"):
        export(kuka_model(), "urdf", tmp_path / "x.urdf", lugre=True)


def test_the_urdf_is_the_same_robot(tmp_path):
    path = arm(tmp_path, {"elbow": LAW, "rail": LAW})
    _, file = written(path, "urdf", tmp_path / "out", speeds=(0.1, 2.0))
    text = file.read_text()
    read = mujoco.MjModel.from_xml_string(text)
    own = mujoco.MjModel.from_xml_string(ARM.format(user=0))
    assert [read.joint(i).name for i in range(read.njnt)] == [
        own.joint(i).name for i in range(own.njnt)
    ]
    assert read.jnt_range[0] == pytest.approx([-2.0, 2.0])
    own.dof_armature[:] = 0.0  # URDF has none
    rng = np.random.default_rng(0)
    for _ in range(5):
        q, v, a = rng.uniform(-1.0, 1.0, (3, own.nv))
        taus = []
        for model in (own, read):
            model.dof_frictionloss[:] = model.dof_damping[:] = 0.0
            model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
            data = mujoco.MjData(model)
            data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
            mujoco.mj_inverse(model, data)
            taus.append(data.qfrc_inverse.copy())
        np.testing.assert_allclose(taus[1], taus[0], rtol=1e-5, atol=1e-6)
    fresh = mujoco.MjModel.from_xml_string(text)
    elbow, rail = (fresh.joint(name).dofadr[0] for name in ("elbow", "rail"))
    assert fresh.dof_frictionloss[elbow] == pytest.approx(1.4, abs=0.01)
    assert fresh.dof_damping[elbow] == pytest.approx(0.3 + 0.3, abs=0.01)
    assert fresh.dof_frictionloss[rail] == pytest.approx(0.2 + 1.4, abs=0.01)


@pytest.fixture
def isaac_actuators(monkeypatch):
    """What an exported file hands to Isaac Lab, by joint: a stand-in with the fields of its 3.0."""

    @dataclasses.dataclass
    class ImplicitActuatorCfg:
        joint_names_expr: list
        stiffness: float | None
        damping: float | None
        friction: float
        dynamic_friction: float
        viscous_friction: float
        armature: float

    module = types.ModuleType("isaaclab.actuators")
    module.ImplicitActuatorCfg = ImplicitActuatorCfg
    monkeypatch.setitem(sys.modules, "isaaclab", types.ModuleType("isaaclab"))
    monkeypatch.setitem(sys.modules, "isaaclab.actuators", module)
    return lambda file: runpy.run_path(str(file))["ACTUATORS"]


def test_isaac_lab_gets_efforts_in_newton_metres_and_newtons(tmp_path, isaac_actuators):
    falls = StaticParameters.symmetric(Fs=2.0, Fc=1.2, Vs=0.02, delta=2.0, sigma2=0.7, V0=1e-3)
    path = arm(tmp_path, {"elbow": falls, "rail": falls})
    _, file = written(path, "isaac", tmp_path / "out", speeds=(0.5, 3.0))
    actuators = isaac_actuators(file)
    # per radian, and of a slide per metre, as its documentation has it; the joints' own added
    own = {"elbow": (0.0, 0.3), "rail": (0.2, 0.0)}
    for name, (loss, damping) in own.items():
        found = actuators[name]
        assert found.dynamic_friction == pytest.approx(1.2 + loss, abs=2e-3)
        assert found.friction == pytest.approx(2.0 + loss)
        assert found.viscous_friction == pytest.approx(0.7 + damping, abs=2e-3)
        # PhysX asks for it
        assert found.dynamic_friction <= found.friction


def test_newton_gets_its_own_words(one_joint, tmp_path):
    _, file = written(one_joint, "newton", tmp_path / "out", speeds=(0.1, 2.0))
    module = runpy.run_path(str(file))
    builder = types.SimpleNamespace(
        joint_label=["arm/worldbody/upper/shoulder", "arm/x/lower/turn_elbow", "arm/x/elbow"],
        joint_qd_start=[0, 1, 2],
        joint_q_start=[0, 1, 2],
        custom_attributes={},
        **{f"joint_{k}": [0.0] * 3 for k in ("friction", "damping", "armature", "stiffness")},
        joint_rest_q=[0.0] * 3,
    )
    module["apply"](builder)
    assert builder.joint_friction == pytest.approx([0.0, 0.0, 1.4], abs=0.01)
    assert builder.joint_stiffness[2] == pytest.approx(2.0)
    # rest where the springs and the constant torques of both directions balance
    assert builder.joint_rest_q[2] == pytest.approx(-(0.3 + 0.1 + 0.1) / 2.0, abs=0.05)
    builder.joint_label[2] = "arm/x/wrist"
    with pytest.raises(KeyError, match="'elbow' is 0 times"):
        module["apply"](builder)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--to", "foo"], "--to foo: give one of native, mjx,"),
        (["--to", "native", "--speeds", "2:1"], "LOW must be above 0"),
        (["--to", "native", "--speeds", "a"], "write LOW:HIGH"),
        (["--to", "native", "--speeds", "1:2", "--log", "x.csv"], "give one of them"),
        (["--to", "native", "--log", "none.csv"], "none.csv"),
        (["--to", "c", "--lugre"], "c has no LuGre"),
    ],
)
def test_bad_input_writes_nothing(arguments, word, one_joint, tmp_path):
    out = tmp_path / "out"
    done = CliRunner().invoke(app, ["export", str(one_joint), *arguments, "--out", str(out)])
    assert isinstance(done.exception, FrictionJointError)
    assert word in str(done.exception)
    assert not out.exists()


def test_the_command_tells_what_is_lost(tmp_path):
    run = CliRunner().invoke(
        app, ["export", str(kuka_model()), "--to", "urdf", "--out", str(tmp_path), "--json"]
    )
    assert run.exit_code == 0, run.output
    said = json.loads(run.output[run.output.index("{") :])
    assert said["file"] == str(tmp_path / "robot.urdf")
    assert Path(said["file"]).is_file()
    (loss,) = said["losses"]
    assert 10.0 < loss["torque_lost"] < loss["torque"] == pytest.approx(38.7, abs=0.5)


def test_a_log_gives_the_motion(tmp_path):
    t = np.arange(0.0, 4.0, 0.005)
    q = 0.4 * np.sin(2.0 * t)
    rows = "\n".join(f"{a},{b},{np.sin(a)}" for a, b in zip(t, q, strict=True))
    log = tmp_path / "log.csv"
    log.write_text("time_s,position_rad,torque_nm\n" + rows)
    (motion,) = log_motions(log, ["elbow"], {}).values()
    assert np.abs(motion.velocity[50:-50] - 0.8 * np.cos(2.0 * t[50:-50])).max() < 0.01
    with pytest.raises(LogError, match="2 joints have friction, name them in the columns"):
        log_motions(log, ["elbow", "turn"], {})
