"""Steps of a model in which some joints are free while the others follow their measured motion."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from frictionjoint.arrays import Array, Index


class Prescribed:
    """Other joints of an arm on their measured motion."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, motion: Mapping[str, Sequence[Array]]
    ) -> None:
        """From position, velocity and acceleration by name, (n,) each; joints that the model lacks
        are left out."""
        ids = {n: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, n) for n in motion}
        names = [n for n, j in ids.items() if j >= 0]
        joints = [ids[n] for n in names]
        at, dofs = _places(model.jnt_qposadr[joints]), _places(model.jnt_dofadr[joints])
        each = [np.array([motion[n][i] for n in names]).T.copy() for i in range(3)]
        # every look into `data` makes an array anew
        moved = zip((data.qpos, data.qvel, data.qacc), (at, dofs, dofs), each, strict=True)
        self._moved = list(moved) if names else []

    def __bool__(self) -> bool:
        return bool(self._moved)

    def put(self, k: int) -> None:
        """Set the positions, velocities and accelerations of the other joints at a sample."""
        for array, at, track in self._moved:
            array[at] = track[k]


def _places(at: Index) -> Index | slice:
    """Places in an array, as a slice if they follow each other: that is several times as fast."""
    follow = len(at) > 0 and np.array_equal(at, np.arange(at[0], at[0] + len(at)))
    return slice(int(at[0]), int(at[0]) + len(at)) if follow else at.astype(int)


class Free:
    """Joints that are free to move; all others have the accelerations in the data.

    Inverse dynamics with zero acceleration of the free joints gives the torque of everything else;
    the difference to the applied torque accelerates them. `dt` is the time step, s.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: list[int]) -> None:
        self._model, self._data, self.dt = model, data, model.opt.timestep
        self._at = _places(model.jnt_qposadr[joints])
        self._dofs = _places(model.jnt_dofadr[joints])
        # every look into `data` makes an array anew
        self._qpos, self._qvel, self._qacc = data.qpos, data.qvel, data.qacc
        self._inverse = data.qfrc_inverse
        self._units = np.eye(model.nv)[self._dofs]
        self._rows = np.empty_like(self._units)

    def step(self, torque: Array) -> None:
        """One semi-implicit step with torques on the first free joints."""
        self.accelerate(torque)
        self.advance()

    def accelerate(self, torque: Array) -> None:
        """Set the accelerations that torques on the first free joints cause."""
        self._qacc[self._dofs] = 0.0
        mujoco.mj_inverse(self._model, self._data)
        for row, unit in zip(self._rows, self._units, strict=True):
            mujoco.mj_mulM(self._model, self._data, row, unit)
        taken = -self._inverse[self._dofs]
        taken[: len(torque)] += torque
        mass = self._rows[:, self._dofs]
        gained = taken / mass[0] if len(taken) == 1 else np.linalg.solve(mass, taken)
        self._qacc[self._dofs] = gained

    def advance(self) -> None:
        """Move on by a time step with these accelerations."""
        self._qvel[self._dofs] += self.dt * self._qacc[self._dofs]
        self._qpos[self._at] += self.dt * self._qvel[self._dofs]
