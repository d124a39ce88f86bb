"""Motion of every body of a tree along a trajectory, all samples at once.

MuJoCo's own conventions (`mj_kinematics`): the joints of a body act one after the other in its
parent's frame; a free joint states its linear motion in the world and its angular one in the body.
"""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from frictionjoint.arrays import Array

_FREE, _BALL, _SLIDE, _HINGE = (
    int(getattr(mujoco.mjtJoint, f"mjJNT_{kind}")) for kind in ("FREE", "BALL", "SLIDE", "HINGE")
)


@dataclass(frozen=True)
class Trajectory:
    """Of all coordinates of a model.

    Attributes:
        q: shape (n, nq). v, a: velocity and acceleration, shape (n, nv).
    """

    q: Array
    v: Array
    a: Array

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True)
class Frame:
    """A frame in the world along a trajectory.

    Attributes:
        p, R: origin (n, 3) and orientation (n, 3, 3).
        w, alpha, a: angular velocity, angular and linear acceleration of the origin, (n, 3).
    """

    p: Array
    R: Array
    w: Array
    alpha: Array
    a: Array

    def point(self, r: Array) -> tuple[Array, Array]:
        """Place and acceleration of the point at r from the origin in this frame, shape (3,)."""
        arm = self.R @ r
        return self.p + arm, self.a + _turning(self.w, self.alpha, arm)

    def within(self, x: Array) -> Array:
        """World vectors seen in this frame, shape (n, 3)."""
        return np.asarray(np.einsum("nij,ni->nj", self.R, x))


@dataclass(frozen=True)
class Dof:
    """A degree of freedom along a trajectory.

    Attributes:
        axis: in the world, shape (n, 3). point: on the axis; None: it moves along the axis.
    """

    axis: Array
    point: Array | None


class Tree:
    """Topology of a compiled model."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model

    @cached_property
    def beyond(self) -> list[list[int]]:
        """Bodies that each degree of freedom moves."""
        found: list[list[int]] = [[] for _ in range(self.model.nv)]
        for b in range(1, self.model.nbody):
            up = b
            while up:
                first = int(self.model.body_dofadr[up])
                for dof in range(first, first + int(self.model.body_dofnum[up])):
                    found[dof].append(b)
                up = int(self.model.body_parentid[up])
        return found

    def along(self, trajectory: Trajectory) -> tuple[list[Frame], list[Dof]]:
        """Frames of all bodies, the world first, and all degrees of freedom."""
        n, model = len(trajectory), self.model
        still = np.zeros((n, 3))
        world = Frame(still, np.tile(np.eye(3), (n, 1, 1)), still, still, still)
        frames, dofs = [world], []
        for b in range(1, model.nbody):
            frame = _attached(frames[model.body_parentid[b]], model.body_pos[b], model.body_quat[b])
            first = int(model.body_jntadr[b])
            for j in range(first, first + int(model.body_jntnum[b])):
                frame, own = _through(model, j, frame, trajectory)
                dofs += own
            frames.append(frame)
        return frames, dofs


def _attached(parent: Frame, r: Array, quat: Array) -> Frame:
    """A frame fixed in its parent."""
    p, a = parent.point(r)
    return Frame(p, parent.R @ _matrix(quat), parent.w, parent.alpha, a)


def _through(
    model: mujoco.MjModel, j: int, frame: Frame, trajectory: Trajectory
) -> tuple[Frame, list[Dof]]:
    """The frame behind a joint, and the joint's degrees of freedom."""
    kind, at, dof = int(model.jnt_type[j]), int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])
    axis, anchor = model.jnt_axis[j], model.jnt_pos[j]
    if kind == _FREE:
        R = _rotation(trajectory.q[:, at + 3 : at + 7])
        turn, spin = (_turned(R, x[:, dof + 3 : dof + 6]) for x in (trajectory.v, trajectory.a))
        p, a = trajectory.q[:, at : at + 3], trajectory.a[:, dof : dof + 3]
        moves = [Dof(np.tile(e, (len(p), 1)), None) for e in np.eye(3)]
        return Frame(p, R, turn, spin, a), moves + [Dof(R[:, :, k], p) for k in range(3)]
    if kind == _BALL:
        R = frame.R @ _rotation(trajectory.q[:, at : at + 4])
        turn, spin = (_turned(R, x[:, dof : dof + 3]) for x in (trajectory.v, trajectory.a))
        found, o = _turning_about(frame, anchor, R, turn, spin)
        return found, [Dof(R[:, :, k], o) for k in range(3)]
    s = trajectory.q[:, at] - model.qpos0[at]
    v, a = trajectory.v[:, dof, None], trajectory.a[:, dof, None]
    z = frame.R @ axis
    if kind == _SLIDE:
        arm = z * s[:, None]
        linear = frame.a + _turning(frame.w, frame.alpha, arm)
        linear = linear + 2.0 * np.cross(frame.w, z) * v + z * a
        moved = Frame(frame.p + arm, frame.R, frame.w, frame.alpha, linear)
        return moved, [Dof(z, None)]
    R = frame.R @ _about(axis, s)
    found, o = _turning_about(frame, anchor, R, z * v, z * a)
    return found, [Dof(z, o)]


def _turning_about(
    frame: Frame, anchor: Array, R: Array, turn: Array, spin: Array
) -> tuple[Frame, Array]:
    """A frame turned about a point fixed in it, and that point.

    Args:
        R: its orientation. turn, spin: angular velocity relative to `frame`, and its rate.
    """
    o, a = frame.point(anchor)
    w, alpha = frame.w + turn, frame.alpha + spin + np.cross(frame.w, turn)
    arm = -(R @ anchor)
    return Frame(o + arm, R, w, alpha, a + _turning(w, alpha, arm)), o


def _turning(w: Array, alpha: Array, arm: Array) -> Array:
    """Acceleration of the end of an arm relative to its beginning."""
    return np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))


def _turned(R: Array, x: Array) -> Array:
    return np.asarray(np.einsum("nij,nj->ni", R, x))


def _matrix(quat: Array) -> Array:
    return np.asarray(_rotation(quat[None, :])[0])


def _rotation(quat: Array) -> Array:
    """Rotation matrices of quaternions, made unit as MuJoCo does, shape (n, 3, 3)."""
    w, x, y, z = (quat / np.linalg.norm(quat, axis=1, keepdims=True)).T
    rows = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def _about(axis: Array, angle: Array) -> Array:
    """Rotations about a unit axis, shape (n, 3, 3)."""
    half = 0.5 * angle
    return _rotation(np.column_stack([np.cos(half), np.sin(half)[:, None] * axis]))
