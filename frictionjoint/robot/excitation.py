"""The trajectory to record next: the one that best determines a robot's rigid body.

A Fourier series per joint (Swevers, Ganseman, Tukel, De Schutter and Van Brussel 1997) that fades
in and out at a pose, within the ranges, speeds and torques of the logs and the model, without
contacts. Series are drawn at random and scaled into the limits; the best one has the largest
determinant of the resulting information matrix.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.report.robot_report import Excitation
from frictionjoint.robot.causes.catalogue import links_of
from frictionjoint.robot.information import (
    Information,
    base_parameters,
    errors,
    gram_without,
)
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.kinematics import Trajectory, Tree
from frictionjoint.robot.regressor import Regressor

_SECONDS, _HARMONICS = 20.0, 5


@dataclass(frozen=True)
class _Limits:
    """Limits of each joint, shape (joints,) each: range, speed, torque."""

    low: Array
    high: Array
    speed: Array
    torque: Array


def next_trajectory(
    joints: Sequence[FittedJoint], moving: Sequence[str], known: Information, seed: int
) -> Excitation | None:
    """The best of many trajectories; None if none is free of contact within the limits."""
    rng = np.random.default_rng(seed)
    model = joints[0].alongs[0].model
    limits = _limits(model, joints)
    base = base_parameters(known)
    at = list(base.base)
    before = errors(known, at)
    best: tuple[float, Array, Array] | None = None
    time = np.linspace(0.0, _SECONDS, 400)
    for _ in range(60):
        series = (
            rng.normal(size=(2, _HARMONICS, len(joints))) / np.arange(1, _HARMONICS + 1)[:, None]
        )
        middle = rng.uniform(0.3, 0.7, len(joints))
        scale = _within(model, joints, limits, series, middle, time)
        if scale is None:
            continue
        further = _gram(model, joints, moving, known, _motion(limits, scale * series, middle, time))
        after = Information(known.parameters, known.gram + further)
        inner = after.gram[np.ix_(at, at)]
        worth = float(np.linalg.slogdet(inner)[1])
        if best is None or worth > best[0]:
            best = (worth, scale * series, middle)
            fallen = errors(after, at) / before
    if best is None:
        return None
    fine = np.arange(0.0, _SECONDS, 0.01)
    q, _, _ = _motion(limits, best[1], best[2], fine)
    loosest = int(np.argmax(before))
    fall = float(np.median(fallen)), float(fallen[loosest])
    names, slides = tuple(j.name for j in joints), tuple(j.prepared.slide for j in joints)
    return Excitation(names, slides, fine, q, fall)


def _limits(model: mujoco.MjModel, joints: Sequence[FittedJoint]) -> _Limits:
    rows = []
    for joint in joints:
        signals = np.concatenate([s.signals for s in joint.prepared.segments])
        drive = np.concatenate([s.drive for s in joint.prepared.segments]) * joint.fit.gain
        low, high = float(signals[:, Q].min()), float(signals[:, Q].max())
        # where the model states no range: a quarter of the travel of the logs beyond it
        room = 0.25 * (high - low)
        low, high = low - room, high + room
        j = model.joint(joint.name).id
        if model.jnt_limited[j]:
            # 90% of ranges and torques, 125% of the speeds of the logs
            middle, half = np.mean(model.jnt_range[j]), 0.45 * np.ptp(model.jnt_range[j])
            low, high = float(middle - half), float(middle + half)
        torque = float(np.abs(drive).max())
        if model.jnt_actfrclimited[j]:
            torque = 0.9 * float(np.abs(model.jnt_actfrcrange[j]).min())
        rows.append((low, high, 1.25 * float(np.abs(signals[:, V]).max()), torque))
    return _Limits(*np.array(rows).T)


def _motion(
    limits: _Limits, series: Array, middle: Array, time: Array
) -> tuple[Array, Array, Array]:
    """Positions, velocities and accelerations, shape (n, joints) each."""
    w = 2.0 * np.pi / _SECONDS * np.arange(1, _HARMONICS + 1)
    angle = np.outer(time, w)
    waves = (np.sin(angle), np.cos(angle))
    moved = waves[0] @ series[0] + waves[1] @ series[1]
    # the first and the last tenth of the time
    edge = np.clip(np.minimum(time, _SECONDS - time) / (0.1 * _SECONDS), 0.0, 1.0)
    fade = edge**3 * (10.0 - 15.0 * edge + 6.0 * edge**2)
    centre = limits.low + middle * (limits.high - limits.low)
    q = centre + fade[:, None] * moved
    v = np.gradient(q, time, axis=0)
    return q, v, np.gradient(v, time, axis=0)


def _within(
    model: mujoco.MjModel,
    joints: Sequence[FittedJoint],
    limits: _Limits,
    series: Array,
    middle: Array,
    time: Array,
) -> Array | None:
    """Scales of each joint's series that keep all limits."""
    q, _, _ = _motion(limits, series, middle, time)
    centre = limits.low + middle * (limits.high - limits.low)
    moved = np.abs(q - centre).max(axis=0)
    scale: Array = np.minimum(centre - limits.low, limits.high - centre) / np.maximum(moved, 1e-12)
    for _ in range(12):
        q, v, a = _motion(limits, scale * series, middle, time)
        slow = limits.speed / np.maximum(np.abs(v).max(axis=0), 1e-12)
        if np.any(slow < 1.0):
            scale = scale * np.minimum(1.0, slow)
            continue
        heavy, touches = _checked(model, joints, q, v, a, limits)
        if not touches and not heavy.any():
            return scale
        scale = scale * (0.8 if touches else np.where(heavy, 0.8, 1.0))
    return None


def _checked(
    model: mujoco.MjModel,
    joints: Sequence[FittedJoint],
    q: Array,
    v: Array,
    a: Array,
    limits: _Limits,
) -> tuple[Array, bool]:
    """Joints that would require too much torque, and whether bodies touch."""
    flags = int(model.opt.disableflags)
    model.opt.disableflags = flags & ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    before = data.ncon
    at = [int(model.joint(j.name).qposadr[0]) for j in joints]
    dofs = [int(model.joint(j.name).dofadr[0]) for j in joints]
    peak, touches = np.zeros(len(joints)), False
    for k in range(0, len(q), 4):
        data.qpos[at], data.qvel[dofs], data.qacc[dofs] = q[k], v[k], a[k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        touches = touches or data.ncon > before
        data.ncon = 0
        mujoco.mj_inverse(model, data)
        peak = np.maximum(peak, np.abs(data.qfrc_inverse[dofs]))
    model.opt.disableflags = flags
    return np.asarray(peak > limits.torque), touches


def _gram(
    model: mujoco.MjModel,
    joints: Sequence[FittedJoint],
    moving: Sequence[str],
    known: Information,
    motion: tuple[Array, Array, Array],
) -> Array:
    """Information that a trajectory would add, sampled as the logs are."""
    q, v, a = motion
    qs = np.tile(model.qpos0, (len(q), 1))
    vs, accelerations = (np.zeros((len(q), model.nv)) for _ in range(2))
    for i, joint in enumerate(joints):
        entry = model.joint(joint.name)
        qs[:, int(entry.qposadr[0])] = q[:, i]
        vs[:, int(entry.dofadr[0])], accelerations[:, int(entry.dofadr[0])] = v[:, i], a[:, i]
    regressor = Regressor(Tree(model), Trajectory(qs, vs, accelerations))
    names = [j.name for j in joints]
    bodies = links_of(model, names, moving)
    sizes = np.array([p.size for p in known.parameters])
    G = np.zeros_like(known.gram)
    for i, joint in enumerate(joints):
        dof = int(model.joint(joint.name).dofadr[0])
        rotors = np.zeros((len(q), len(joints)))
        rotors[:, i] = a[:, i]
        X = np.column_stack([*(regressor.body(b, dof) for b in bodies), rotors])
        top = float(np.abs(v[:, i]).max()) or 1.0
        friction = np.column_stack([np.tanh(v[:, i] / (0.02 * top)), v[:, i], np.ones(len(q))])
        segment = joint.prepared.segments[0]
        samples = _SECONDS / (segment.dt * segment.step) / len(q)
        G += samples * gram_without(X * sizes / joint.left, friction)
    return G
