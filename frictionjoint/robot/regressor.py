"""Torques of a rigid-body tree as columns times parameters, along a trajectory.

The force and moment that a body's motion takes are linear in its ten parameters, and the torque at
a degree of freedom is their component along its axis (Atkeson, An and Hollerbach 1986).
"""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.inertia import TEN, matrix, of_model
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
        self._columns: dict[tuple[int, int], Array] = {}

    def body(self, body: int, dof: int) -> Array:
        """Torque at a degree of freedom per unit of a body's ten parameters, shape (n, 10)."""
        if body not in self.tree.beyond[dof]:
            return np.zeros((len(self.trajectory), TEN))
        key = body, dof
        if key not in self._columns:
            if body not in self._wrenches:
                self._wrenches[body] = _wrench(self.frames[body], self._felt(body))
            force, moment = self._wrenches[body]
            self._columns[key] = _component(self.dofs[dof], self.frames[body], force, moment)
        return self._columns[key]

    def bodies(self, dof: int) -> Array:
        """Columns of all bodies in turn, the world's first, shape (n, 10 nbody)."""
        return np.concatenate([self.body(b, dof) for b in range(self.tree.model.nbody)], axis=1)

    def torque(self, dof: int, phi: Array | None = None) -> Array:
        """Torque of all bodies at a degree of freedom, shape (n,).

        Args:
            phi: of all bodies, shape (nbody, 10); None: the model's.
        """
        phi = of_model(self.tree.model) if phi is None else phi
        found = np.zeros(len(self.trajectory))
        for b in self.tree.beyond[dof]:
            frame = self.frames[b]
            force, moment = _loads(frame, self._felt(b), phi[b])
            axis, point = self.dofs[dof].axis, self.dofs[dof].point
            if point is not None:
                force = moment + _cross_product(frame.p - point, force)
            found += np.einsum("ni,ni->n", axis, force)
        return found

    def gravity_columns(self, dof: int, phi: Array | None = None) -> Array:
        """Torque at a degree of freedom per m/s^2 of gravity along x, y and z, shape (n, 3).

        Args:
            phi: of all bodies, shape (nbody, 10); None: the model's.
        """
        phi = of_model(self.tree.model) if phi is None else phi
        axis, point = self.dofs[dof].axis, self.dofs[dof].point
        moved = np.zeros((len(self.trajectory), 3))
        for b in self.tree.beyond[dof]:
            frame, felt = self.frames[b], 1.0 - float(self.tree.model.body_gravcomp[b])
            arm = axis * phi[b, 0]
            if point is not None:
                arm = _cross_product(axis, frame.R @ phi[b, 1:4] + phi[b, 0] * (frame.p - point))
            moved -= felt * arm
        return moved

    def _felt(self, body: int) -> Array:
        """Gravity that a body feels: what compensates it in the model does so of new mass too."""
        return (1.0 - float(self.tree.model.body_gravcomp[body])) * self.gravity


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


def _loads(frame: Frame, gravity: Array, phi: Array) -> tuple[Array, Array]:
    """Force and moment about the frame's origin, in the world, of ten parameters, (n, 3) each."""
    a, w, alpha = frame.a - gravity, frame.w, frame.alpha
    h = frame.R @ phi[1:4]
    force = phi[0] * a + _cross_product(alpha, h) + _cross_product(w, _cross_product(w, h))
    inertia = matrix(phi)

    def spun(x: Array) -> Array:
        return np.asarray(np.einsum("nij,nj->ni", frame.R, frame.within(x) @ inertia))

    return force, _cross_product(h, a) + spun(alpha) + _cross_product(w, spun(w))


def _cross_product(x: Array, y: Array) -> Array:
    """As numpy's, which is several times slower on tall arrays."""
    out = np.empty_like(y)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, i] = x[:, j] * y[:, k] - x[:, k] * y[:, j]
    return out


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
