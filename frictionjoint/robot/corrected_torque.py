"""Rigid-body torque of one joint along one log, and its change with corrections of the model.

The torque is linear in the parameters of bodies, rotors and shafts, so its columns are filtered and
decimated once, and any change of corrections is a sum of them.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from typing import Any

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import GEAR, LOAD, A, Q, V
from frictionjoint.identify.rigid_body import RigidBody, direction
from frictionjoint.identify.segment import Segment
from frictionjoint.robot.corrections import Corrections, Shaft, concave_friction
from frictionjoint.robot.kinematics import Trajectory, Tree
from frictionjoint.robot.regressor import Regressor


@dataclass(frozen=True)
class Along:
    """Torque of one joint along one log, and its derivatives on the kept samples: with the model
    `body` around the joint, the log `original` as prepared with it, and present corrections."""

    body: RigidBody
    original: Segment
    state: Corrections

    def __getstate__(self) -> dict[str, object]:
        """State for pickling, without the cached columns, which are large but quick to compute."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def corrected(self, state: Corrections) -> "Along":
        """The columns with other corrections."""
        found = replace(self, state=state)
        # what does not depend on what changed is not made again
        same = ["tree", "dof", "_believed", "_others", "rate"]
        if self.state.moves_alike(state):
            same += ["regressor", "_columns"]
            bodies = [(b, self.state.phi[b].tobytes()) for b in self.tree.beyond[self.dof]]
            torques = self._torques
            found._torques.update({key: torques[key] for key in bodies if key in torques})
        found.__dict__.update({k: self.__dict__[k] for k in same if k in self.__dict__})
        return found

    @cached_property
    def dof(self) -> int:
        return int(self.model.jnt_dofadr[self.body.joint_id])

    @property
    def model(self) -> mujoco.MjModel:
        """The user's model, with the fixed positions of joints that no log contains."""
        return self.body.model

    @cached_property
    def tree(self) -> Tree:
        return Tree(self.model)

    @cached_property
    def regressor(self) -> Regressor:
        """Regressor along the corrected motion, with the corrected gravity."""
        return Regressor(self.tree, self._trajectory(self.state.offset), self.state.gravity)

    @cached_property
    def torque(self) -> Array:
        """Torque of all corrected bodies over the whole grid, shape (n,)."""
        found = np.zeros(len(self.original.signals))
        for b in self.tree.beyond[self.dof]:
            phi = self.state.phi[b]
            key = b, phi.tobytes()
            if key not in self._torques:
                self._torques[key] = self.regressor.torque_of(b, self.dof, phi)
            found += self._torques[key]
        return found

    @cached_property
    def _torques(self) -> dict[tuple[int, bytes], Array]:
        """Torque of each body by its parameters, shape (n,)."""
        return {}

    def bodies(self, body: int) -> Array:
        """Torque per unit of a body's ten parameters, shape (k, 10)."""
        return self._once(body, lambda: self.original.balanced(self.regressor.body(body, self.dof)))

    def _once(self, key: Any, made: Callable[[], Array]) -> Array:
        """A column that depends on the motion and gravity alone, computed once."""
        if key not in self._columns:
            self._columns[key] = made()
        return self._columns[key]

    @cached_property
    def _columns(self) -> dict[Any, Array]:
        return {}

    @cached_property
    def gravity(self) -> Array:
        """Torque per m/s^2 of gravity along x, y and z, shape (k, 3)."""
        return self.original.balanced(self.regressor.gravity_columns(self.dof, self.state.phi))

    def offset(self, joint: str) -> Array:
        """Torque per rad (m) of a joint's zero, shape (k,)."""
        beyond = self.tree.beyond[int(self.model.joint(joint).dofadr[0])]
        bodies = [b for b in self.tree.beyond[self.dof] if b in beyond]

        def turned() -> Array:
            step = 1e-5  # rad (m)
            moved = self.state.offset | {joint: self.state.offset.get(joint, 0.0) + step}
            other = Regressor(self.tree, self._trajectory(moved), self.state.gravity)
            columns = (self.original.balanced(other.body(b, self.dof)) for b in bodies)
            found = [(x - self.bodies(b)) / step for b, x in zip(bodies, columns, strict=True)]
            return np.array(found)

        found = np.zeros(len(self.rate))
        for b, x in zip(bodies, self._once(joint, turned), strict=True):
            found += x @ self.state.phi[b]
        return found

    def shaft(self, shaft: Shaft) -> Array:
        """Torque per unit of a shaft's parameters over the whole grid, shape (n, 6)."""
        turn, v, a = self.turn(shaft)
        way, angle = direction(v), shaft.waves * turn
        wave = [way * np.sin(angle), way * np.cos(angle)]
        columns = np.column_stack([way, v, concave_friction(v, shaft.top), a, *wave])
        return columns * shaft.per_turn(self.body.joint)

    def turn(self, shaft: Shaft) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of a shaft, each of shape (n,)."""
        first, second = (self.motion(name) for name in shaft.joints)
        turn, v, a = (x + shaft.ratio * y for x, y in zip(first, second, strict=True))
        return turn, v, a

    def kept_shaft(self, shaft: Shaft) -> Array:
        """Torque per unit of a shaft's parameters, shape (k, 6)."""
        return self.original.balanced(self.shaft(shaft))

    def linear(self, before: Corrections, after: Corrections) -> Array:
        """Change of torque between two corrections near this state, to first order, (k,)."""
        found = np.zeros(len(self.rate))
        bodies = np.flatnonzero(np.any(after.phi != before.phi, axis=1))
        for b in set(bodies.tolist()) & set(self.tree.beyond[self.dof]):
            found += self.bodies(b) @ (after.phi[b] - before.phi[b])
        turn = after.gravity - before.gravity
        if np.any(turn):
            found += self.gravity @ turn
        own = self.body.joint
        found += self.rate * (after.armature.get(own, 0.0) - before.armature.get(own, 0.0))
        for name in after.offset:
            change = after.offset[name] - before.offset.get(name, 0.0)
            if change:
                found += self.offset(name) * change
        for shaft, other in zip(after.shafts, before.shafts, strict=True):
            step = np.subtract(shaft.numbers, other.numbers)
            if np.any(step):
                found += self._once(shaft.bare, partial(self.kept_shaft, shaft)) @ step
        return found

    @cached_property
    def rate(self) -> Array:
        """Acceleration of the joint on the kept samples, shape (k,)."""
        return self.original.balanced(self.original.signals[:, A])

    def segment(self, like: Segment) -> Segment:
        """A log, `like` with its present weights, with the load of the corrected model."""
        change = self.torque - self._believed + self.of_shafts()
        return self._loaded(like, change, self._armature)

    def other(self, state: Corrections) -> Segment:
        """The log with the load under other corrections, where `original` has that under these."""
        here = self.torque + self.of_shafts()
        found = self.corrected(state)
        change = found.torque + found.of_shafts() - here
        return self._loaded(self.original, change, found._armature - self._armature)

    def _loaded(self, like: Segment, change: Array, armature: float) -> Segment:
        """A log with a change of the original's load, without and with the joint's own rotor."""
        before, signals = self.original.signals, like.signals.copy()
        signals[:, LOAD] = before[:, LOAD] + change + armature * before[:, A]
        signals[:, GEAR] = before[:, GEAR] + change
        return replace(like, signals=signals, driven_along=None)

    @property
    def _armature(self) -> float:
        return self.state.armature.get(self.body.joint, 0.0)

    def of_shafts(self) -> Array:
        """Torque of all shafts over the whole grid, shape (n,)."""
        found = np.zeros(len(self.original.signals))
        for shaft in self.state.shafts:
            found += self.shaft(shaft) @ shaft.numbers
        return found

    @cached_property
    def _believed(self) -> Array:
        """Torque of the bodies of the user's model over the whole grid, shape (n,)."""
        return replace(self, state=Corrections.none(self.model)).torque

    def _trajectory(self, offset: dict[str, float]) -> Trajectory:
        n, model = len(self.original.signals), self.model
        q = np.tile(model.qpos0, (n, 1))
        v, a = (np.zeros((n, model.nv)) for _ in range(2))
        for name in {self.body.joint, *self._others}:
            j = model.joint(name).id
            dof = int(model.jnt_dofadr[j])
            position, v[:, dof], a[:, dof] = self.motion(name)
            q[:, int(model.jnt_qposadr[j])] = position + offset.get(name, 0.0)
        return Trajectory(q, v, a)

    @cached_property
    def _others(self) -> set[str]:
        named = {name.rpartition(".")[0] for name in self.original.others}
        return named & self.body.joint_names

    def motion(self, name: str) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of a joint; zero if the log does not contain it."""
        if name == self.body.joint:
            s = self.original.signals
            return s[:, Q], s[:, V], s[:, A]
        if name not in self._others:
            still = np.zeros(len(self.original.signals))
            return still, still, still
        kinds = ("position", "velocity", "acceleration")
        position, velocity, acceleration = (self.original.others[f"{name}.{k}"] for k in kinds)
        return position, velocity, acceleration
