"""The library of motors, and BAM's files read and written."""

import json
import math
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from frictionjoint.cli import app
from frictionjoint.errors import FrictionJointError, ParameterError
from frictionjoint.files import read_parameters, toml_text
from frictionjoint.law.motion import friction_torque
from frictionjoint.motors.bam import MODELS, BamParameters, from_bam, read_bam, to_bam
from frictionjoint.motors.library import get_motor, list_motors
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.check import check

MODELS_FOLDER = Path(__file__).resolve().parents[1] / "models"
MOTOR = {"kt": 0.38, "R": 3.4, "armature": 0.0019, "q_offset": 0.03}
NUMBERS = {
    "friction_base": 0.009,
    "friction_viscous": 0.005,
    "friction_stribeck": 0.004,
    "dtheta_stribeck": 2.5,
    "alpha": 1.0,
    "load_friction_base": 0.07,
    "load_friction_stribeck": 0.05,
    "load_friction_motor": 0.20,
    "load_friction_external": 0.06,
    "load_friction_motor_stribeck": 0.03,
    "load_friction_external_stribeck": 0.08,
    "load_friction_motor_quad": 0.009,
    "load_friction_external_quad": 0.004,
}


def bam(model, **changed):
    own = {name: NUMBERS[name] for name in MODELS[model]}
    return BamParameters(model, "xl330", {**own, **changed}, MOTOR)


def budget(b, tm, te, v):
    """BAM's friction budget, written down from its documentation; model M1 to M6."""
    f = {**dict.fromkeys(NUMBERS, 0.0), **b.friction}
    falls = "alpha" in b.friction
    E = math.exp(-(abs(v / f["dtheta_stribeck"]) ** f["alpha"])) if falls else 0.0
    load, slow = f["load_friction_base"] * abs(tm - te), f["load_friction_stribeck"] * abs(tm - te)
    if b.model in ("m5", "m6"):
        load = abs(f["load_friction_motor"] * tm - f["load_friction_external"] * te)
        motor, out = f["load_friction_motor_stribeck"], f["load_friction_external_stribeck"]
        slow = abs(motor * tm - out * te)
    total = f["friction_base"] + f["friction_viscous"] * abs(v) + load
    return total + E * (f["friction_stribeck"] + slow)


def ours(joint, load, v):
    """The torque of steady sliding: the law's, and the load effect's formula."""
    t = np.linspace(0.0, 2.0, 2001)
    total = friction_torque(joint.parameters, t, v * t)[-1]
    for effect in joint.effects:
        if effect.effect.name == "load-dependent":
            c = effect.coefficients
            falling = c[1] * math.exp(-abs(v) / effect.shape[1]) if len(c) > 1 else 0.0
            total += (c[0] + falling) * abs(load)
    return total


@pytest.mark.parametrize("model", ["m1", "m2", "m3", "m4", "m5"])
@pytest.mark.parametrize("v", [0.1, 1.0, 6.0])
@pytest.mark.parametrize("load", [0.0, 0.3])
def test_a_held_load_meets_the_same_friction(model, v, load):
    read = bam(model)
    joint, _ = from_bam(read)
    assert ours(joint, load, v) == pytest.approx(budget(read, load, -load, v), rel=1e-6)


@pytest.mark.parametrize("model", ["m1", "m2", "m3", "m4"])
def test_there_and_back_is_the_same_file(model):
    read = bam(model)
    joint, _ = from_bam(read)
    made, _ = to_bam(joint, read)
    assert made.model == model
    assert made.motor == read.motor
    for name, value in read.friction.items():
        assert made.friction[name] == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("model", ["m5", "m6"])
def test_of_two_sides_the_sum_remains(model):
    read = bam(model)
    joint, said = from_bam(read)
    assert any("who drives makes no difference" in line for line in said)
    assert any("quadratic" in line for line in said) == (model == "m6")
    back, _ = to_bam(joint, read, model)
    sides = back.friction["load_friction_motor"], back.friction["load_friction_external"]
    assert sides == pytest.approx((0.13, 0.13))
    assert to_bam(joint, read)[0].model == "m4"


def test_what_has_no_counterpart_is_said():
    _, said = from_bam(bam("m4", alpha=1.7))
    text = " ".join(said)
    for word in ("before sliding", "kt 0.38", "armature 0.0019", "q_offset", "exponent 1.7"):
        assert word in text
    joint = get_motor("ur10_j3").friction
    made, said = to_bam(joint, bam("m1"), "m1")
    text = " ".join(said)
    assert "integrated law before sliding" in text
    assert "does not fall with speed" in text
    assert made.actuator == "xl330"


def test_bad_files_are_refused(tmp_path):
    path = tmp_path / "m.json"
    for text, word in (
        ("{", "not JSON"),
        ("[]", "no parameter file of BAM"),
        ('{"model": "m7", "actuator": "x"}', "no model 'm7'"),
        ('{"model": "m1", "actuator": "x", "friction_base": 1}', "lacks friction_viscous"),
        (
            '{"model": "m1", "actuator": "x", "friction_base": "a", "friction_viscous": 0}',
            "friction_base is 'a'",
        ),
    ):
        path.write_text(text)
        with pytest.raises(ParameterError, match=r"m\.json") as error:
            read_bam(path)
        assert word in str(error.value)
    with pytest.raises(ParameterError, match=r"none\.json: cannot be read"):
        read_bam(tmp_path / "none.json")


def call(*arguments):
    return CliRunner().invoke(app, ["motors", *map(str, arguments)])


def test_the_command_goes_both_ways(tmp_path):
    source = tmp_path / "m4.json"
    source.write_text(bam("m4").to_json())
    done = call("from-bam", source, "--out", tmp_path / "m.toml")
    assert done.exit_code == 0, done.output
    assert "Without counterpart" in done.output
    back = tmp_path / "back.json"
    done = call("to-bam", tmp_path / "m.toml", "--like", source, "--out", back)
    assert done.exit_code == 0, done.output
    first, second = (json.loads(x.read_text()) for x in (source, back))
    assert first.keys() == second.keys()
    assert second["load_friction_base"] == pytest.approx(first["load_friction_base"])
    refused = call("to-bam", tmp_path / "m.toml", "--like", source, "--model", "m9", "--out", "x")
    assert isinstance(refused.exception, FrictionJointError)
    assert "no model 'm9'" in str(refused.exception)


@pytest.mark.parametrize("motor", list_motors(), ids=lambda motor: motor.name)
def test_every_motor_says_where_it_is_from_and_goes_into_a_model(tmp_path, motor):
    assert motor.source.startswith("https://")
    assert motor.licence
    assert motor.conditions
    assert motor.command.startswith("frictionjoint close-loop ")
    assert re.fullmatch("[0-9a-f]{64}", motor.logs)
    assert re.fullmatch("[0-9a-f]{12}", motor.version)
    assert (MODELS_FOLDER / motor.model).exists()
    out = tmp_path / f"{motor.name}.toml"
    assert call("get", motor.name, "--out", out).exit_code == 0
    assert read_parameters(out) == motor.friction
    assert toml_text(motor.friction.parameters, motor.friction.effects) == out.read_text()
    model = mujoco.MjSpec.from_file(str(MODELS_FOLDER / motor.model))
    # what saturates has to be there
    drive = model.add_actuator(trntype=mujoco.mjtTrn.mjTRN_JOINT, target=motor.joint)
    drive.set_to_motor()
    install(model, {motor.joint: motor.friction.parameters}, {motor.joint: motor.friction.effects})
    compiled = model.compile()
    data = mujoco.MjData(compiled)
    with attach(compiled):
        mujoco.mj_step(compiled, data, 20)
    assert np.isfinite(data.qpos).all()


def names_listed(*arguments):
    return [row["name"] for row in json.loads(call("list", "--json", *arguments).stdout)]


def test_lists_of_all_and_of_one_robot_and_a_motor_with_its_curve():
    assert names_listed() == [motor.name for motor in list_motors()]
    assert "ur10_j1" in call().output
    assert names_listed("--robot", "panda") == [f"panda_joint{i}" for i in range(1, 8)]
    refused = str(call("list", "--robot", "spot").exception)
    assert "--robot spot: no motor of this name, there are " in refused
    assert "Dynamixel XL330 servo, EMPS" in refused
    content = json.loads(call("show", "ur10_j1", "--json").stdout)
    motor = get_motor("ur10_j1")
    curve = content["friction_speed"]
    law = motor.friction.parameters
    assert curve["pos"][-1] > 0.9 * min(law.Fc_pos, law.Fs_pos)
    assert len(curve["speed"]) == len(curve["neg"])
    plain = call("show", "ur10_j1").stdout
    assert motor.source in plain
    assert "speed, rad/s" in plain


def held(motor, inertia, seconds):
    """A joint that carries 0.4 of its slow sliding friction, and its position every 10 ms."""
    law, kind = motor.friction.parameters, "slide" if motor.unit == "N" else "hinge"
    spec = mujoco.MjSpec.from_string(
        "<mujoco><option timestep='0.001' integrator='implicitfast' gravity='0 0 0'/><worldbody>"
        f"<body><joint name='j' type='{kind}'/><inertial pos='0 0 0' mass='{inertia}' "
        f"diaginertia='{inertia} {inertia} {inertia}'/></body></worldbody></mujoco>"
    )
    install(spec, {"j": law})
    model = spec.compile()
    assert not [x for row in check(model) for x in row["outside"]]
    data = mujoco.MjData(model)
    t = np.linspace(0.0, 20.0, 20001)
    data.qfrc_applied[0] = 0.4 * float(friction_torque(law, t, 0.01 * t)[-1])
    places = []
    with attach(model):
        for _ in range(100 * seconds):
            mujoco.mj_step(model, data, 10)
            places.append(float(data.qpos[0]))
    return np.array(places)


@pytest.mark.parametrize("motor", list_motors(), ids=lambda x: x.name)
def test_every_motor_holds_its_load_and_passes_the_strict_check(motor):
    """Its own inertia stays where it is for 30 s, to 1e-6 rad; 0.5 kg m² does not drift."""
    model = mujoco.MjModel.from_xml_path(str(MODELS_FOLDER / motor.model))
    own = 1.0 / float(model.dof_invweight0[model.joint(motor.joint).dofadr[0]])
    assert np.ptp(held(motor, own, 40)[1000:]) < 1e-6
    drift = np.diff(held(motor, 0.5, 15)[500:].reshape(2, -1).mean(axis=1))
    assert abs(drift[0]) < 1e-4
