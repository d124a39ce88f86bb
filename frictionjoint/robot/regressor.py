"""Torques of a rigid-body tree as columns times parameters, along a trajectory.

The force and moment that a body's motion takes are linear in its ten parameters, and the torque at
a degree of freedom is their component along its axis (Atkeson, An and Hollerbach 1986).
"""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.inertia import TEN, of_model
from frictionjoint.robot.kinematics import Dof, Frame, Trajectory, Tree


class Regressor:
    """Columns of one trajectory.

    Args:
        gravity: m/s^2 in the world, shape (3,); None: the model's.
    """

    def __init__(self, tree: Tree, trajectory: Trajectory, gravity: Array | None = None) -> None:
        self.tree = tree
        self.trajectory = trajectory
        self.gravity = np.array(tree.model.opt.gravity if gravity is None else gravity)
        self.frames, self.dofs = tree.along(trajectory)
        self._wrenches: dict[int, tuple[Array, Array]] = {}

    def body(self, body: int, dof: int) -> Array:
        """Torque at a degree of freedom per unit of a body's ten parameters, shape (n, 10)."""
        if body not in self.tree.beyond[dof]:
            return np.zeros((len(self.trajectory), TEN))
        if body not in self._wrenches:
            # what compensates gravity in the model compensates it of the new mass too
            felt = (1.0 - float(self.tree.model.body_gravcomp[body])) * self.gravity
            self._wrenches[body] = _wrench(self.frames[body], felt)
        force, moment = self._wrenches[body]
        return _component(self.dofs[dof], self.frames[body], force, moment)

    def bodies(self, dof: int) -> Array:
        """Columns of all bodies in turn, the world's first, shape (n, 10 nbody)."""
        return np.concatenate([self.body(b, dof) for b in range(self.tree.model.nbody)], axis=1)

    def torque(self, dof: int, phi: Array | None = None) -> Array:
        """Torque of all bodies at a degree of freedom, shape (n,).

        Args:
            phi: of all bodies, shape (nbody, 10); None: the model's.
        """
        phi = of_model(self.tree.model) if phi is None else phi
        parts = [self.body(b, dof) @ phi[b] for b in self.tree.beyond[dof]]
        return np.asarray(sum(parts, np.zeros(len(self.trajectory))))


def gravity_columns(tree: Tree, trajectory: Trajectory, dof: int) -> Array:
    """Torque at a degree of freedom per m/s^2 of gravity along x, y and z, shape (n, 3)."""
    still = trajectory.at_rest()
    return np.column_stack([Regressor(tree, still, e).torque(dof) for e in np.eye(3)])


def _wrench(frame: Frame, gravity: Array) -> tuple[Array, Array]:
    """Force and moment about the frame's origin, in the frame, by ten parameters, (n, 3, 10)."""
    a = frame.within(frame.a - gravity)
    w, alpha = frame.within(frame.w), frame.within(frame.alpha)
    n = len(a)
    force, moment = np.zeros((n, 3, TEN)), np.zeros((n, 3, TEN))
    force[:, :, 0] = a
    W = _cross(w)
    force[:, :, 1:4] = _cross(alpha) + W @ W
    moment[:, :, 1:4] = -_cross(a)
    moment[:, :, 4:] = _spread(alpha) + W @ _spread(w)
    return force, moment


def _component(dof: Dof, frame: Frame, force: Array, moment: Array) -> Array:
    z = frame.within(dof.axis)
    if dof.point is None:
        return np.asarray(np.einsum("ni,nik->nk", z, force))
    arm = frame.within(frame.p - dof.point)
    return np.asarray(
        np.einsum("ni,nik->nk", z, moment) + np.einsum("ni,nik->nk", np.cross(z, arm), force)
    )


def _cross(x: Array) -> Array:
    """Matrices of the cross product with x, shape (n, 3, 3)."""
    X = np.zeros((len(x), 3, 3))
    X[:, 0, 1], X[:, 0, 2], X[:, 1, 2] = -x[:, 2], x[:, 1], -x[:, 0]
    X[:, 1, 0], X[:, 2, 0], X[:, 2, 1] = x[:, 2], -x[:, 1], x[:, 0]
    return X


def _spread(x: Array) -> Array:
    """Matrices that take (Ixx, Ixy, Ixz, Iyy, Iyz, Izz) to I x, shape (n, 3, 6)."""
    L = np.zeros((len(x), 3, 6))
    L[:, 0, 0], L[:, 0, 1], L[:, 0, 2] = x.T
    L[:, 1, 1], L[:, 1, 3], L[:, 1, 4] = x.T
    L[:, 2, 2], L[:, 2, 4], L[:, 2, 5] = x.T
    return L
