"""The models say what models/README.md says, and explain the logs they go with."""

import json
import tomllib
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd
import pytest
from scipy.signal import butter, filtfilt

import frictionjoint as fj
from frictionjoint.simulate.carrier import read_friction

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
def test_joints_and_units(name):
    model = model_of(name)
    assert [model.joint(i).name for i in range(model.njnt)] == JOINTS[name]
    assert 'compiler angle="radian"' in (MODELS / f"{name}.xml").read_text()
    assert np.allclose(np.linalg.norm(model.jnt_axis, axis=1), 1)
    assert np.abs(model.jnt_range).max() <= 2 * np.pi + 1e-3
    kind = mujoco.mjtJoint.mjJNT_SLIDE if name == "emps" else mujoco.mjtJoint.mjJNT_HINGE
    assert (model.jnt_type == kind).all()


@pytest.mark.parametrize("name", JOINTS)
def test_no_native_friction_no_contact(name):
    model = model_of(name)
    assert not np.any(model.dof_frictionloss)
    assert not np.any(model.dof_damping)
    assert not np.any(model.geom_contype)
    assert not np.any(model.geom_conaffinity)


@pytest.mark.parametrize("name", MASS)
def test_total_mass(name):
    assert model_of(name).body_mass.sum() == pytest.approx(MASS[name], abs=1e-6)


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


def kuka_friction() -> fj.FrictionParameters:
    path = MODELS / "kuka_ir361_joint1.friction.toml"
    return fj.FrictionParameters.from_dict(tomllib.loads(path.read_text()))


def test_kuka_friction_figures():
    friction = kuka_friction()
    assert (friction.Fc_pos, friction.sigma2_pos) == (34.26, 10.78)
    assert 2e5 <= friction.stiffness <= 4e5
    assert len(friction.knots) == 3


def test_kuka_carries_the_friction_of_its_toml():
    carried = read_friction(model_of("kuka_ir361_joint1"))
    assert carried["joint1"].parameters == kuka_friction()


def test_pendulum_hangs_at_zero_and_has_the_tip_mass():
    model = model_of("xl330_pendulum")
    weight = 0.49 * 9.80665 * 0.1
    for q in (-1.0, 0.0, 0.4, np.pi / 2):
        assert at(model, q).qfrc_inverse[0] == pytest.approx(weight * np.sin(q), abs=1e-12)
    assert inertia(model) == pytest.approx(0.49 * 0.1**2 + 0.002 + 1e-6)


def test_emps_is_horizontal():
    model = model_of("emps")
    assert at(model).qfrc_inverse[0] == pytest.approx(0, abs=1e-12)
    assert inertia(model) == pytest.approx(95.109)


def test_panda_reaches_as_its_dh_table_says():
    model = model_of("panda")
    flange = at(model, *np.zeros(7)).site("flange").xpos
    assert flange == pytest.approx([0.088, 0, 0.333 + 0.316 + 0.384 - 0.107], abs=1e-9)
    assert model.joint("joint4").range == pytest.approx([-3.0718, -0.0698])


def test_ur10_reach_and_shoulder_load():
    data = at(model_of("ur10"), *np.zeros(6))
    # Stretched along -x: flange at a2 + a3, and the masses beyond the shoulder times their arms.
    expected = [-0.612 - 0.5723, -0.163941 - 0.0922, 0.1273 - 0.1157]
    assert data.site("flange").xpos == pytest.approx(expected, abs=1e-9)
    moment = 12.7 * 0.232 + 4.27 * (0.612 + 0.3323) + 4.365 * (0.612 + 0.5723)
    assert abs(data.qfrc_inverse[1]) == pytest.approx(9.81 * moment, rel=1e-6)


def test_tx40_stands_upright_at_zero():
    data = at(model_of("staubli_tx40"), *np.zeros(6))
    assert data.body("link_3").xpos == pytest.approx([0, 0.035, 0.32 + 0.225], abs=1e-9)
    assert data.body("link_4").xpos == pytest.approx([0, 0.035, 0.32 + 0.45], abs=1e-9)


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


def test_kr300_stands_as_the_log_starts():
    data = at(model_of("kuka_kr300"), *np.zeros(6))
    assert data.body("forearm").xpos == pytest.approx([0.35, -0.189, 0.675 + 1.15], abs=1e-9)
    assert data.body("hand").xpos == pytest.approx([1.35, 0, 1.825 - 0.041], abs=1e-9)


# Shares of the torque's standard deviation left after friction, as models/README.md says.
LEFT = {
    "panda": [0.18, 0.032, 0.055, 0.051, 0.11, 0.08, 0.27],
    "ur10": [0.13, 0.036, 0.06, 0.07, 0.09, 0.30],
    "staubli_tx40": [0.053, 0.095, 0.11, 0.11, 0.53, 0.33],
    "kuka_kr300": [0.23, 0.32, 0.47, 0.39, 0.17, 0.19],
}


def read_log(name: str, folder: Path):
    """Time, positions and torques of all joints, shapes (n,), (n, joints), (n, joints)."""
    if name == "panda":
        parts = (folder / f"panda/exciting_traj_{x}.txt" for x in ("time", "positions", "torques"))
        t, q, tau = (np.loadtxt(path) for path in parts)
        return t, q.reshape(-1, 7), tau.reshape(-1, 7)
    if name == "staubli_tx40":
        ratio = np.diag([32.0, 32, 45, -48, 45, 32])
        ratio[5, 4] = 32
        motor = pd.read_csv(folder / "staubli_tx40/pos_read_data.csv").to_numpy()
        current = pd.read_csv(folder / "staubli_tx40/curr_data.csv").to_numpy()
        return np.arange(len(motor)) / 5000, motor @ np.linalg.inv(ratio).T, current @ ratio
    log = pd.read_csv(folder / {"ur10": "unisa_ur10/ur10.csv"}.get(name, "kuka_kr300/A.csv"))
    seat = dict.fromkeys(JOINTS[name], "position_rad")
    seat |= dict.fromkeys(["axis4", "axis5", "axis6"], "motor_position_rad")
    q = log[[f"{joint}.{seat[joint]}" for joint in JOINTS[name]]].to_numpy()
    tau = log[[f"{joint}.torque_nm" for joint in JOINTS[name]]].to_numpy()
    return log["time_s"].to_numpy(), q, tau


def smooth_motion(t, q, tau):
    """Position, velocity, acceleration and torque, all behind the same 15 Hz zero-phase filter."""
    step = float(np.median(np.diff(t)))
    grid = np.arange(t[0], t[-1], step)
    b, a = butter(4, 15 * 2 * step)

    def filtered(x):
        resampled = np.stack([np.interp(grid, t, column) for column in x.T], axis=1)
        return filtfilt(b, a, resampled, axis=0)

    q, tau = filtered(q), filtered(tau)
    v = np.gradient(q, step, axis=0)
    acc = np.gradient(v, step, axis=0)
    every = slice(int(0.3 / step), -int(0.3 / step), max(1, round(0.008 / step)))
    return [x[every] for x in (q, v, acc, tau)]


def rigid_torque(model: mujoco.MjModel, q, v, acc):
    """Inverse dynamics along a motion, joint limits left out, shape (n, joints)."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(model)
    torque = np.empty_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], acc[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    return torque


def fit(torque, *motions):
    """Least squares with Coulomb, viscous, inertia per motion (v, a), and an offset, the last."""
    columns = [x for v, acc in motions for x in (np.tanh(v / 0.02), v, acc)]
    A = np.stack([*columns, np.ones(len(torque))], axis=1)
    found = np.linalg.lstsq(A, torque, rcond=None)[0]
    return found, float(np.std(torque - A @ found))


@pytest.mark.parametrize("name", LEFT)
def test_model_explains_its_log(name, measured_data):
    q, v, acc, tau = smooth_motion(*read_log(name, measured_data))
    rigid = rigid_torque(model_of(name), q, v, acc)
    for j, share in enumerate(LEFT[name]):
        _, left = fit(tau[:, j] - rigid[:, j], (v[:, j], acc[:, j]))
        assert left / np.std(tau[:, j]) == pytest.approx(share, rel=0.1), JOINTS[name][j]


def test_tx40_motor_6_rubs_at_joints_5_and_6(measured_data):
    q, v, acc, tau = smooth_motion(*read_log("staubli_tx40", measured_data))
    y = tau - rigid_torque(model_of("staubli_tx40"), q, v, acc)
    motor6 = v[:, 4] + v[:, 5], acc[:, 4] + acc[:, 5]
    for j, share in ((4, 0.12), (5, 0.14)):
        _, left = fit(y[:, j], (v[:, j], acc[:, j]), motor6)
        assert left / np.std(tau[:, j]) == pytest.approx(share, rel=0.1)


def test_kr300_carries_150_kg(measured_data):
    q, v, acc, tau = smooth_motion(*read_log("kuka_kr300", measured_data))
    offset = {}
    for payload in (150.0, 1.0):
        model = model_of("kuka_kr300")
        model.body("payload").mass = payload
        y = tau - rigid_torque(model, q, v, acc)
        offset[payload] = abs(fit(y[:, 1], (v[:, 1], acc[:, 1]))[0][-1])
    assert offset[150.0] < 150
    assert offset[1.0] > 1500


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
