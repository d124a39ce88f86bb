"""The trajectory to record next: the one that best determines a robot's rigid body.

A Fourier series per joint (Swevers, Ganseman, Tukel, De Schutter and Van Brussel 1997) that fades
in and out at a pose, within the ranges, speeds and torques of the logs and the model, without
contacts. Series are drawn at random and scaled into the limits; the best one has the largest
determinant of the resulting information matrix.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.report.robot_report import Excitation
from frictionjoint.robot.causes.catalogue import links_of
from frictionjoint.robot.information import BaseParameters, Information, errors, gram_without
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.kinematics import Trajectory, Tree
from frictionjoint.robot.regressor import Regressor

_SECONDS, _HARMONICS = 20.0, 5


def next_trajectory(
    joints: Sequence[FittedJoint], moving: Sequence[str], known: Information, seed: int
) -> Excitation | None:
    """The best of many trajectories; None if none is free of contact within the limits."""
    rng = np.random.default_rng(seed)
    robot = _Robot(joints)
    at = BaseParameters(known).base
    before = errors(known, at)
    best: tuple[float, Array, Array, Array] | None = None
    time = np.linspace(0.0, _SECONDS, 400)
    for _ in range(60):
        series = (
            rng.normal(size=(2, _HARMONICS, len(joints))) / np.arange(1, _HARMONICS + 1)[:, None]
        )
        middle = rng.uniform(0.3, 0.7, len(joints))
        centre = robot.low + middle * (robot.high - robot.low)
        scale = robot.scale_within(series, centre, time)
        if scale is None:
            continue
        further = robot.gram(moving, known, *robot.motion(scale * series, centre, time))
        after = Information(known.parameters, known.gram + further)
        worth = float(np.linalg.slogdet(after.gram[np.ix_(at, at)])[1])
        if best is None or worth > best[0]:
            best = worth, scale * series, centre, errors(after, at) / before
    if best is None:
        return None
    _, series, centre, fallen = best
    fine = np.arange(0.0, _SECONDS, 0.01)
    q, _, _ = robot.motion(series, centre, fine)
    loosest = int(np.argmax(before))
    fall = float(np.median(fallen)), float(fallen[loosest])
    names, slides = tuple(j.name for j in joints), tuple(j.prepared.slide for j in joints)
    return Excitation(names, slides, fine, q, fall)


class _Robot:
    """Addresses of the joints in a model; limits of range, speed and torque, shape (joints,)."""

    def __init__(self, joints: Sequence[FittedJoint]) -> None:
        model = joints[0].alongs[0].model
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
        named = [model.joint(joint.name) for joint in joints]
        self.model, self.joints = model, joints
        self.at = [int(j.qposadr[0]) for j in named]
        self.dofs = [int(j.dofadr[0]) for j in named]
        self.low, self.high, self.speed, self.torque = np.array(rows).T

    def motion(self, series: Array, centre: Array, time: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations about a pose, shape (n, joints) each."""
        w = 2.0 * np.pi / _SECONDS * np.arange(1, _HARMONICS + 1)
        angle = np.outer(time, w)
        moved = np.sin(angle) @ series[0] + np.cos(angle) @ series[1]
        # the first and the last tenth of the time
        edge = np.clip(np.minimum(time, _SECONDS - time) / (0.1 * _SECONDS), 0.0, 1.0)
        fade = edge**3 * (10.0 - 15.0 * edge + 6.0 * edge**2)
        q = centre + fade[:, None] * moved
        v = np.gradient(q, time, axis=0)
        return q, v, np.gradient(v, time, axis=0)

    def scale_within(self, series: Array, centre: Array, time: Array) -> Array | None:
        """Scales of each joint's series that keep all limits; None if none are found."""
        q, _, _ = self.motion(series, centre, time)
        moved = np.abs(q - centre).max(axis=0)
        scale: Array = np.minimum(centre - self.low, self.high - centre) / np.maximum(moved, 1e-12)
        for _ in range(12):
            q, v, a = self.motion(scale * series, centre, time)
            slow = self.speed / np.maximum(np.abs(v).max(axis=0), 1e-12)
            if np.any(slow < 1.0):
                scale = scale * np.minimum(1.0, slow)
                continue
            heavy, touches = self._checked(q, v, a)
            if not touches and not heavy.any():
                return scale
            scale = scale * (0.8 if touches else np.where(heavy, 0.8, 1.0))
        return None

    def _checked(self, q: Array, v: Array, a: Array) -> tuple[Array, bool]:
        """Joints that would require too much torque, and whether bodies touch."""
        model = self.model
        flags = int(model.opt.disableflags)
        model.opt.disableflags = flags & ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        before = data.ncon
        at, dofs = self.at, self.dofs
        peak, touches = np.zeros(len(dofs)), False
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
        return np.asarray(peak > self.torque), touches

    def gram(
        self, moving: Sequence[str], known: Information, q: Array, v: Array, a: Array
    ) -> Array:
        """Information that a motion would add, sampled as the logs are."""
        model, n = self.model, len(q)
        qs = np.tile(model.qpos0, (n, 1))
        vs, accelerations = (np.zeros((n, model.nv)) for _ in range(2))
        qs[:, self.at], vs[:, self.dofs], accelerations[:, self.dofs] = q, v, a
        regressor = Regressor(Tree(model), Trajectory(qs, vs, accelerations))
        bodies = links_of(model, [j.name for j in self.joints], moving)
        sizes = np.array([p.size for p in known.parameters])
        G = np.zeros_like(known.gram)
        for i, (joint, dof) in enumerate(zip(self.joints, self.dofs, strict=True)):
            rotors = np.zeros((n, len(self.joints)))
            rotors[:, i] = a[:, i]
            X = np.column_stack([*(regressor.body(b, dof) for b in bodies), rotors])
            top = float(np.abs(v[:, i]).max()) or 1.0
            friction = np.column_stack([np.tanh(v[:, i] / (0.02 * top)), v[:, i], np.ones(n)])
            segment = joint.prepared.segments[0]
            samples = _SECONDS / (segment.dt * segment.step) / n
            G += samples * gram_without(X * sizes / joint.left, friction)
        return G
