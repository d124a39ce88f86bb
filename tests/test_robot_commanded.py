"""A whole leg in logs of targets and positions: no torque was measured in any joint."""

import json

import mujoco
import numpy as np
import pytest

from frictionjoint import close_loop
from frictionjoint.report.folder import write_report
from frictionjoint.simulate.carrier import read_friction

# s: of the plant and its controller; a target comes, and a row is logged, once in so many
TICK, EVERY = 5e-4, 10
KP, KD, ROTOR = {"hip": 30.0, "knee": 25.0}, 0.8, 0.03
CONTROLLER = f"""output = "torque_nm"
kp = {KP["hip"]}
kd = {KD}
[joint.knee]
kp = {KP["knee"]}
"""
LEG = """<mujoco><compiler angle="radian"/><worldbody><body pos="0 0 1">
  <joint name="hip" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.01"/>
  <inertial pos="0 0.02 -0.1" mass="1" diaginertia="4e-3 4e-3 1e-3"/>
  <body pos="0 0 -0.2">
    <joint name="knee" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="{}"/>
    <inertial pos="0 0 -0.1" mass="0.3" diaginertia="1e-3 1e-3 1e-4"/>
  </body></body></worldbody></mujoco>"""
LINES = {"hip": [(0.5, 0.7), (0.2, 2.3)], "knee": [(0.6, 1.1), (0.25, 2.9)]}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A log of a leg whose model lacks the knee's rotor, and that model."""
    folder = tmp_path_factory.mktemp("leg")
    model = mujoco.MjModel.from_xml_string(LEG.format(ROTOR))
    model.opt.timestep = TICK
    data = mujoco.MjData(model)
    time = TICK * np.arange(16_000)
    w = 2.0 * np.pi * time
    waves = [sum(a * np.sin(f * w + i) for i, (a, f) in enumerate(x)) for x in LINES.values()]
    target = np.repeat(np.column_stack(waves)[::EVERY], EVERY, axis=0)
    position = np.empty_like(target)
    data.qpos[:] = target[0]
    gains = np.array(list(KP.values()))
    for k in range(len(time)):
        position[k] = data.qpos
        data.qfrc_applied[:] = gains * (target[k] - data.qpos) - KD * data.qvel
        mujoco.mj_step(model, data)
    position += 2e-5 * np.random.default_rng(0).standard_normal(position.shape)
    columns = {"time_s": time}
    for i, joint in enumerate(LINES):
        columns |= {f"{joint}.position_rad": position[:, i], f"{joint}.target_rad": target[:, i]}
    table = np.column_stack(list(columns.values()))[::EVERY]
    np.savetxt(folder / "leg.csv", table, delimiter=",", header=",".join(columns), comments="")
    believed = folder / "leg.xml"
    believed.write_text(LEG.format(0.0))
    controller = folder / "leg.toml"
    controller.write_text(CONTROLLER)
    return folder / "leg.csv", believed, controller


@pytest.fixture(scope="module")
def report(files):
    log, model, controller = files
    return close_loop([log], model, controller=controller)


def test_joints_are_explained_and_the_knee_follows_its_target(report):
    assert list(report.joints) == ["hip", "knee"]
    before, after = report.before.torque_percent.held_out, report.after.torque_percent.held_out
    assert after < 0.05 * before
    knee = report.joints["knee"]
    assert knee.after_replay.held_out < 0.1 * knee.before_replay.held_out
    own = report.to_dict()["joints"]["knee"]
    before, after = (own[stage]["closed_loop_mae"]["held_out"] for stage in ("before", "after"))
    assert after < 0.1 * before
    assert "diverges" not in report.summary()
    # no torque was measured that could be replayed
    assert report.before.replay_rms.held_out is None
    assert report.after.replay_rms.held_out is None


def test_the_rotor_that_the_model_lacks_is_named(report):
    (cause,) = report.shared
    assert (cause.cause, cause.place) == ("rotor-inertia", {"joint": "knee"})
    assert cause.parameters["armature"].value == pytest.approx(ROTOR, rel=0.02)
    # it does not act on the hip, whose error therefore is one, not two of different fits
    hip = report.joints["hip"]
    assert (hip.before_torque, hip.other_before) == (hip.after_torque, False)


def test_each_joints_controller_is_written(report, tmp_path):
    write_report(report, tmp_path, "frictionjoint close-loop")
    for name, kp in KP.items():
        assert f"kp = {kp}\n" in (tmp_path / f"joint_{name}.controller.toml").read_text()
    assert json.loads((tmp_path / "report.json").read_text())["schema"] == "frictionjoint/report-2"


def test_the_model_carries_what_was_refined(report):
    carried = read_friction(mujoco.MjSpec.from_string(report.mjcf).compile())
    for name, joint in report.joints.items():
        assert joint.refined is not None
        assert carried[name] == joint.carried
