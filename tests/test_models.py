"""The models say what models/README.md says, explain their logs, and stick and slip as the KUKA."""

import json
import tomllib
from pathlib import Path

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.stick_slip import SPEED, kuka_model, stick_slip

MODELS = Path(__file__).resolve().parents[1] / "models"
JOINTS = {
    "kuka_ir361_joint1": ["joint1"],
    "xl330_pendulum": ["pendulum"],
    "sts3215_pendulum": ["pendulum"],
    "sts3215_pendulum_heavy": ["pendulum"],
    "emps": ["carriage"],
    "panda": [f"joint{i}" for i in range(1, 8)],
    "ur10": [f"j{i}" for i in range(1, 7)],
    "staubli_tx40": [f"joint_{i}" for i in range(1, 7)],
    "kuka_kr300": [f"axis{i}" for i in range(1, 7)],
    "bldc_motor": ["rotor"],
    "ri50_motor": ["rotor"],
    "kinova_gen3_joint7": ["joint_7"],
    "ak80_double_pendulum": ["joint1", "joint2"],
    "fr3": [f"joint{i}" for i in range(1, 8)],
    "ur10e": [f"j{i}" for i in range(1, 7)],
    "am_d02": ["second", "third", "fourth", "fifth", "sixth", "sixthoutput", "seventh"],
    "so101": ["Rotation", "Pitch", "Elbow", "Wrist_Pitch", "Wrist_Roll", "Jaw"],
    "go2": [
        f"{leg}_{x}_joint" for leg in ("FL", "FR", "RL", "RR") for x in ("hip", "thigh", "calf")
    ],
}
MASS = {"panda": 16.062132, "ur10": 28.435, "staubli_tx40": 23.01, "kuka_kr300": 1074.77}
MASS |= {
    "ur10e": 28.7,
    "am_d02": 3.810741,
    "go2": 8.285408,
    "so101": 0.497006,
    "fr3": 16.254813,
    "ak80_double_pendulum": 1.163726,
}


def model_of(name: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))


def at(model: mujoco.MjModel, *qpos: float) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = qpos or model.qpos0
    mujoco.mj_inverse(model, data)
    return data


def test_every_model_in_the_folder_is_known():
    assert {path.stem for path in MODELS.glob("*.xml")} == set(JOINTS)
    text = (MODELS / "README.md").read_text()
    assert all(f"`{name}.xml`" in text for name in JOINTS)


@pytest.mark.parametrize("name", JOINTS)
def test_joints_units_and_mass_without_native_friction_or_contact(name):
    model = model_of(name)
    assert [model.joint(i).name for i in range(model.njnt)] == JOINTS[name]
    assert 'compiler angle="radian"' in (MODELS / f"{name}.xml").read_text()
    assert np.allclose(np.linalg.norm(model.jnt_axis, axis=1), 1)
    assert np.abs(model.jnt_range).max() <= 2 * np.pi + 1e-3
    kind = mujoco.mjtJoint.mjJNT_SLIDE if name == "emps" else mujoco.mjtJoint.mjJNT_HINGE
    assert (model.jnt_type == kind).all()
    for own in ("dof_frictionloss", "dof_damping", "geom_contype", "geom_conaffinity"):
        assert not np.any(getattr(model, own)), own
    if name in MASS:
        assert model.body_mass.sum() == pytest.approx(MASS[name], abs=1e-6)


def inertia(model: mujoco.MjModel) -> float:
    """Inertia of the only joint: the inverse dynamics of unit acceleration, gravity taken off."""
    data = at(model)
    still = data.qfrc_inverse[0]
    data.qacc[0] = 1
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse[0] - still


def test_kuka_ir361():
    model = model_of("kuka_ir361_joint1")
    assert inertia(model) == pytest.approx(23.8)
    assert at(model, 1.0).qfrc_inverse[0] == pytest.approx(0, abs=1e-12)
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.01
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == pytest.approx(10)
    data.ctrl[0] = 1
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == 393
    content = tomllib.loads((MODELS / "kuka_ir361_joint1.friction.toml").read_text())
    friction = read_friction(model)["joint1"].parameters
    assert friction == fj.FrictionParameters.from_dict(content)


def test_pendulum_hangs_at_zero_and_has_the_tip_mass():
    model = model_of("xl330_pendulum")
    weight = 0.49 * 9.80665 * 0.1
    for q in (-1.0, 0.0, 0.4, np.pi / 2):
        assert at(model, q).qfrc_inverse[0] == pytest.approx(weight * np.sin(q), abs=1e-12)
    assert inertia(model) == pytest.approx(0.49 * 0.1**2 + 0.002 + 1e-6)


def test_kr300_counterbalance_follows_the_gas_law():
    model = model_of("kuka_kr300")
    area = np.pi * (0.055**2 - 0.03**2) / 4
    for degrees in (-24.0, 0.0, 29.0):
        q = np.deg2rad(degrees)
        data = at(model, 0, q, 0, 0, 0, 0)
        length = np.sqrt(0.8**2 + 0.2**2 - 2 * 0.8 * 0.2 * np.cos(q + np.deg2rad(5)))
        assert data.ten_length[0] == pytest.approx(length, abs=1e-5)
        gas = 1.01 * 296.8 * 328 * 0.159 / (0.00096 - (length - 0.6) * area) * area
        force = model.tendon_stiffness.ravel()[0] * (length - model.tendon_lengthspring[0, 1])
        assert force == pytest.approx(gas, rel=0.015)


def test_pendulum_gravity_has_the_sign_of_the_logs(measured_data):
    rows = []
    for path in sorted((measured_data / "xl330").glob("*.json")):
        log = json.loads(path.read_text())
        assert (log["mass"], log["length"]) == (0.49, 0.1)
        for e in log["entries"]:
            if e["torque_enable"] and abs(e["speed"]) < 0.5:
                duty = (e["load"] - 65536 * (e["load"] > 32767)) / 885
                rows.append((e["position"], duty * e["input_volts"]))
    q, volts = np.array(rows).T
    A = np.stack([np.sin(q), np.cos(q), np.ones(len(q))], axis=1)
    sine, cosine, _ = np.linalg.lstsq(A, volts, rcond=None)[0]
    assert sine > 3
    assert abs(cosine) < 0.2 * sine


def test_slips_and_sticks_of_the_kuka_joint_repeat():
    run = stick_slip(kuka_model())
    # stored: 0.1096 rad, 0.227 s, at 1 ms; slip is about vd pi sqrt(J/kp) and more
    assert len(run.slip_distances) >= 8
    np.testing.assert_allclose(run.slip_distances[1:], 0.1096, rtol=0.01)
    np.testing.assert_allclose(run.stick_times, 0.227, atol=0.01)
    # on average the joint keeps up with the target
    assert np.mean(run.slip_distances[1:]) / SPEED == pytest.approx(1.1, rel=0.05)


def test_native_frictionloss_does_not_stick():
    native = stick_slip(kuka_model(), native=True)
    assert len(native.slip_distances) == 0
