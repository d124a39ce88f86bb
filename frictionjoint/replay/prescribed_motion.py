"""Steps of a model in which some joints are free while the others follow their measured motion."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from frictionjoint.arrays import Array


class Prescribed:
    """Other joints of an arm on their measured motion."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, motion: Mapping[str, Sequence[Array]]
    ) -> None:
        """`motion`: position, velocity and acceleration by name, (n,) each; joints that the model
        does not contain are left out."""
        ids = {n: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, n) for n in motion}
        names = [n for n, j in ids.items() if j >= 0]
        joints = [ids[n] for n in names]
        at, dofs = model.jnt_qposadr[joints].astype(int), model.jnt_dofadr[joints].astype(int)
        # every look into `data` makes an array anew
        self._moved = ((data.qpos, at), (data.qvel, dofs), (data.qacc, dofs))
        in_time = np.array([motion[n] for n in names]).T if names else np.zeros((0, 3, 0))
        self._motion = np.ascontiguousarray(in_time)

    def __bool__(self) -> bool:
        return self._motion.size > 0

    def put(self, k: int) -> None:
        """Set the positions and velocities of the other joints at a sample."""
        if self:
            for (array, at), row in zip(self._moved, self._motion[k], strict=True):
                array[at] = row


class Free:
    """Joints that are free to move; all others have the accelerations in the data.

    Inverse dynamics with zero acceleration of the free joints gives the torque of everything else;
    the difference to the applied torque accelerates them.

    Attributes:
        dt: time step, s.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: list[int]) -> None:
        self._model, self._data, self.dt = model, data, model.opt.timestep
        # indices of numpy's own type are looked up three times as fast
        self._at = model.jnt_qposadr[joints].astype(int)
        self._dofs = model.jnt_dofadr[joints].astype(int)
        # every look into `data` makes an array anew
        self._qpos, self._qvel, self._qacc = data.qpos, data.qvel, data.qacc
        self._inverse = data.qfrc_inverse
        self._units = np.eye(model.nv)[self._dofs]
        self._rows = np.empty_like(self._units)

    def step(self, torque: Array) -> None:
        """One semi-implicit step with torques on the first free joints."""
        self._qacc[self._dofs] = 0.0
        mujoco.mj_inverse(self._model, self._data)
        for row, unit in zip(self._rows, self._units, strict=True):
            mujoco.mj_mulM(self._model, self._data, row, unit)
        taken = -self._inverse[self._dofs]
        taken[: len(torque)] += torque
        mass = self._rows[:, self._dofs]
        gained = taken / mass[0] if len(taken) == 1 else np.linalg.solve(mass, taken)
        self._qvel[self._dofs] += self.dt * gained
        self._qpos[self._at] += self.dt * self._qvel[self._dofs]
