"""Torques of a rigid-body tree as columns times parameters, along a trajectory.

The force and moment of a body's motion are linear in its ten parameters, and the torque at a degree
of freedom is their component along its axis (Atkeson, An and Hollerbach 1986).
"""

from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.inertia import TEN, matrix
from frictionjoint.robot.kinematics import Dof, Frame, Trajectory, Tree, cross, turned


class Regressor:
    """Torque columns along a trajectory, with a gravity, m/s^2, shape (3,); None: the model's."""

    def __init__(self, tree: Tree, trajectory: Trajectory, gravity: Array | None = None) -> None:
        self.tree = tree
        self.trajectory = trajectory
        self.gravity = np.array(tree.model.opt.gravity if gravity is None else gravity)
        self.frames, self.dofs = tree.along(trajectory)
        self._motions: dict[int, _Motion] = {}

    def body(self, body: int, dof: int) -> Array:
        """Torque at a degree of freedom per unit of a body's ten parameters, shape (n, 10)."""
        if body not in self.tree.beyond[dof]:
            return np.zeros((len(self.trajectory), TEN))
        if body not in self._motions:
            frame = self.frames[body]
            a = frame.within(frame.a - self._felt(body)[:, None])
            self._motions[body] = _Motion(a, frame.within(frame.w), frame.within(frame.alpha))
        found = _component(self.dofs[dof], self.frames[body], self._motions[body])
        return np.ascontiguousarray(found.T)

    def torque_of(self, body: int, dof: int, phi: Array) -> Array:
        """Torque of one body with ten parameters at a degree of freedom before it, shape (n,)."""
        frame = self.frames[body]
        force, moment = _loads(frame, self._felt(body), phi)
        axis, point = self.dofs[dof].axis, self.dofs[dof].point
        if point is not None:
            force = moment + cross(frame.p - point, force)
        return np.asarray(np.sum(axis * force, axis=0))

    def gravity_columns(self, dof: int, phi: Array) -> Array:
        """Torque at a degree of freedom per m/s^2 of gravity, (n, 3); phi: (nbody, 10)."""
        axis, point = self.dofs[dof].axis, self.dofs[dof].point
        moved = np.zeros((len(self.trajectory), 3))
        for b in self.tree.beyond[dof]:
            frame, felt = self.frames[b], 1.0 - float(self.tree.model.body_gravcomp[b])
            arm = axis * phi[b, 0]
            if point is not None:
                arm = cross(axis, phi[b, 1:4] @ frame.R + phi[b, 0] * (frame.p - point))
            moved -= felt * arm.T
        return moved

    def _felt(self, body: int) -> Array:
        """Gravity of a body; gravity compensation of the model applies to added mass too."""
        return (1.0 - float(self.tree.model.body_gravcomp[body])) * self.gravity


class _Motion(NamedTuple):
    """Acceleration of a body less gravity, angular velocity and its rate, in its frame, (3, n)."""

    a: Array
    w: Array
    alpha: Array


def _component(dof: Dof, frame: Frame, motion: _Motion) -> Array:
    """Force or moment along an axis per unit of a body's ten parameters, shape (10, n): the force
    is m a + alpha x h + w x (w x h), the moment about the origin h x a + I alpha + w x I w, with
    the first moments h and the inertia I."""
    a, w, alpha = motion
    z = frame.within(dof.axis)
    u = z if dof.point is None else cross(z, frame.within(frame.p - dof.point))
    found = np.zeros((TEN, z.shape[1]))
    found[0] = np.sum(u * a, axis=0)
    found[1:4] = cross(u, alpha) + w * np.sum(w * u, axis=0) - u * np.sum(w * w, axis=0)
    if dof.point is not None:
        found[1:4] -= cross(z, a)
        found[4:] = _per_inertia(z, alpha) + _per_inertia(cross(z, w), w)
    return found


def _per_inertia(x: Array, y: Array) -> Array:
    """x' I y per unit of Ixx, Ixy, Ixz, Iyy, Iyz, Izz, shape (6, n)."""
    pairs = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    return np.array([x[i] * y[j] + (x[j] * y[i] if i != j else 0.0) for i, j in pairs])


def _loads(frame: Frame, gravity: Array, phi: Array) -> tuple[Array, Array]:
    """Force and moment about the frame's origin, in the world, of ten parameters, (3, n) each."""
    a, w, alpha = frame.a - gravity[:, None], frame.w, frame.alpha
    h = phi[1:4] @ frame.R
    force = phi[0] * a + cross(alpha, h) + cross(w, cross(w, h))
    inertia = matrix(phi)

    def spun(x: Array) -> Array:
        return turned(frame.R, inertia @ frame.within(x))

    return force, cross(h, a) + spun(alpha) + cross(w, spun(w))
