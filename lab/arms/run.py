"""An arm under control: its logs."""

import mujoco
import numpy as np

from .arm import Arm, torque_scale

STEP = 5e-4


class Lugre:
    """Friction of all joints at once, z implicit in the velocity."""

    def __init__(self, level, slope, stiffness, viscous):
        self.level, self.slope, self.stiffness, self.viscous = level, slope, stiffness, viscous
        self.z = np.zeros(len(level))

    def torque(self, v, grown, left=1.0):
        """`left`: part of the friction that warmth leaves."""
        s = left * self.level * (1.0 + self.slope * np.exp(-((v / 0.03) ** 2))) + grown
        self.z = (self.z + STEP * v) / (1.0 + STEP * np.abs(v) * self.stiffness / s)
        return self.stiffness * self.z + left * self.viscous * v


def run(arm: Arm, seed: int, seconds: float = 15.0, rate: float = 250.0, counts: float = 2e5):
    """Columns of a log, by name."""
    rng = np.random.default_rng(seed)
    true = mujoco.MjModel.from_xml_string(arm.true)
    believed = mujoco.MjModel.from_xml_string(arm.believed)
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT)
    for model in (true, believed):
        model.opt.timestep = STEP
        model.opt.disableflags |= off
    data, belief = mujoco.MjData(true), mujoco.MjData(believed)
    n = len(arm.joints)
    t = np.arange(0.0, seconds, STEP)
    reference, rates, pushes = motion(rng, t, n)
    weight = torque_scale(arm.believed)
    kp, kd = 60.0 * weight, 8.0 * weight
    friction = Lugre(arm.level, arm.slope, arm.stiffness, arm.viscous)
    shaft = None
    if arm.shaft:
        i, j, level, viscous = arm.shaft
        one = np.array([level])
        shaft = Lugre(one, np.array([0.2]), one / 1e-3, np.array([viscous]))
    data.qpos[:] = reference[0]
    warmer = np.zeros(len(t))
    if arm.warming:
        rise, tau = arm.warming
        warmer = rise * (1.0 - np.exp(-t / tau))
    every = round(1.0 / (rate * STEP))
    rows, command = [], np.zeros(n)
    load = np.zeros(n)
    for k in range(len(t)):
        q, v = data.qpos.copy(), data.qvel.copy()
        if k % 2 == 0:
            belief.qpos[:], belief.qvel[:], belief.qacc[:] = reference[k], rates[k], pushes[k]
            mujoco.mj_inverse(believed, belief)
            command = belief.qfrc_inverse + kp * (reference[k] - q) + kd * (rates[k] - v)
        if k % every == 0:
            rows.append(np.concatenate([[t[k]], q, command]))
        loss = friction.torque(v, arm.load_level * np.abs(load), 1.0 - arm.fall * warmer[k])
        if shaft is not None:
            size, waves = arm.shaft_wave
            grown = size * np.sin(waves * (q[i] + q[j]))
            lost = shaft.torque(v[[i]] + v[[j]], grown)[0]
            loss[i] += lost
            loss[j] += lost
        load = command / (1.0 + arm.gain) - loss
        data.qfrc_applied[:] = load
        mujoco.mj_step(true, data)
    x = np.array(rows)
    count = 2.0 * np.pi / counts
    columns = {"time_s": x[:, 0]}
    if arm.warming:
        columns["temperature_c"] = 25.0 + np.round(warmer[::every][: len(x)], 1)
    for i, name in enumerate(arm.joints):
        position = np.round(x[:, 1 + i] / count) * count
        noise = 0.01 * weight[i] * rng.normal(size=len(x))
        columns[f"{name}.position_rad"] = position
        columns[f"{name}.torque_nm"] = x[:, 1 + n + i] + noise
    return columns


def motion(rng, t, n):
    """Sums of sines of all joints from rest, with two derivatives, each of shape (len(t), n)."""
    q = np.zeros((len(t), n))
    fade = 1.0 - np.exp(-((t / 0.5) ** 3))
    for i in range(n):
        for f in rng.uniform(0.05, 0.9, 6):
            w, phase = 2 * np.pi * f, rng.uniform(0, 2 * np.pi)
            size = min(0.7, rng.uniform(0.4, 1.2) / w)
            q[:, i] += size * np.sin(w * t + phase)
        q[:, i] = fade * q[:, i] + rng.uniform(-0.4, 0.4)
    v = np.gradient(q, t, axis=0)
    return q, v, np.gradient(v, t, axis=0)


def write_csv(columns: dict, path) -> None:
    """As a log file of the project's own format."""
    text = ",".join(columns)
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=text,
               comments="", fmt="%.9g")  # fmt: skip
