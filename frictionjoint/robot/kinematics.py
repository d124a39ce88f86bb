"""Motion of every body of a tree along a trajectory, all samples at once.

MuJoCo's conventions (`mj_kinematics`): the joints of a body act one after the other in its parent's
frame; a free joint has its linear motion in the world and its angular motion in the body.
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
    """Coordinates of a model: q, shape (n, nq); velocity v and acceleration a, shape (n, nv)."""

    q: Array
    v: Array
    a: Array

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True)
class Frame:
    """A frame in the world along a trajectory, samples last: numpy is fastest on whole rows.

    Attributes:
        p, R: origin (3, n) and orientation (3, 3, n).
        w, alpha, a: angular velocity, angular and linear acceleration of the origin, (3, n).
    """

    p: Array
    R: Array
    w: Array
    alpha: Array
    a: Array

    def point(self, r: Array) -> tuple[Array, Array]:
        """Position and acceleration of the point at r from the origin in this frame, shape (3,)."""
        arm = r @ self.R
        return self.p + arm, self.a + _turning(self.w, self.alpha, arm)

    def within(self, x: Array) -> Array:
        """World vectors in this frame, shape (3, n)."""
        return np.asarray(np.einsum("ijn,in->jn", self.R, x))


@dataclass(frozen=True)
class Dof:
    """A degree of freedom: its axis in the world, shape (3, n); a point on it, None for a slide."""

    axis: Array
    point: Array | None


def cross(x: Array, y: Array) -> Array:
    """Cross products of vectors along the first axis, shape (3, n)."""
    out = np.empty_like(y)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[i] = x[j] * y[k] - x[k] * y[j]
    return out


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
        still = np.zeros((3, n))
        world = Frame(still, np.tile(np.eye(3)[..., None], n), still, still, still)
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
    own = _rotation(quat[:, None])[..., 0]
    return Frame(p, own.T @ parent.R, parent.w, parent.alpha, a)


def _through(
    model: mujoco.MjModel, j: int, frame: Frame, trajectory: Trajectory
) -> tuple[Frame, list[Dof]]:
    """The frame after a joint, and the joint's degrees of freedom."""
    kind, at, dof = int(model.jnt_type[j]), int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])
    axis, anchor = model.jnt_axis[j], model.jnt_pos[j]
    q, v, a = trajectory.q.T[at:], trajectory.v.T[dof:], trajectory.a.T[dof:]
    if kind == _FREE:
        R = _rotation(q[3:7])
        turn, spin = turned(R, v[3:6]), turned(R, a[3:6])
        moves = [Dof(np.tile(e[:, None], q.shape[1]), None) for e in np.eye(3)]
        return Frame(q[:3], R, turn, spin, a[:3]), moves + [Dof(R[:, k], q[:3]) for k in range(3)]
    if kind == _BALL:
        R = np.einsum("ijn,jkn->ikn", frame.R, _rotation(q[:4]))
        found, o = _turning_about(frame, anchor, R, turned(R, v[:3]), turned(R, a[:3]))
        return found, [Dof(R[:, k], o) for k in range(3)]
    s, z = q[0] - model.qpos0[at], axis @ frame.R
    if kind == _SLIDE:
        arm = z * s
        linear = frame.a + _turning(frame.w, frame.alpha, arm)
        linear = linear + 2.0 * cross(frame.w, z) * v[0] + z * a[0]
        moved = Frame(frame.p + arm, frame.R, frame.w, frame.alpha, linear)
        return moved, [Dof(z, None)]
    found, o = _turning_about(frame, anchor, _about(frame.R, axis, s), z * v[0], z * a[0])
    return found, [Dof(z, o)]


def _turning_about(
    frame: Frame, anchor: Array, R: Array, turn: Array, spin: Array
) -> tuple[Frame, Array]:
    """A frame turned about a point fixed in it, and that point; R is its orientation, turn and spin
    its angular velocity relative to `frame`, and the rate of that."""
    o, a = frame.point(anchor)
    w, alpha = frame.w + turn, frame.alpha + spin + cross(frame.w, turn)
    arm = -(anchor @ R)
    return Frame(o + arm, R, w, alpha, a + _turning(w, alpha, arm)), o


def _turning(w: Array, alpha: Array, arm: Array) -> Array:
    """Acceleration of the end of an arm relative to its beginning."""
    return cross(alpha, arm) + cross(w, cross(w, arm))


def turned(R: Array, x: Array) -> Array:
    """Vectors of frames with these orientations in the world, shape (3, n)."""
    return np.asarray(np.einsum("ijn,jn->in", R, x))


def _rotation(quat: Array) -> Array:
    """Rotation matrices of quaternions, normalised as MuJoCo does, (4, n) to (3, 3, n)."""
    w, x, y, z = quat / np.linalg.norm(quat, axis=0)
    return np.array(
        (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
    )


def _about(R: Array, axis: Array, angle: Array) -> Array:
    """Orientations turned about a unit axis fixed in them (Rodrigues), shape (3, 3, n)."""
    across = np.cross(np.eye(3), -axis)  # transposed: axis x e_j in row j
    turned = across @ R
    return np.asarray(R + np.sin(angle) * turned + (1.0 - np.cos(angle)) * (across @ turned))
