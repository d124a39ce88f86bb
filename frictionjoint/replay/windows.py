"""Joints that run freely for half a second at a time, from measured states, driven as measured.

At every restart the joints are set to their measured states, with the friction memory that the laws
have after the measured motion so far. Other joints follow their measured motion, or stay. Where a
log says that a motor is off, no motor acts. Temperatures are those of the log at the restart.
"""

from collections.abc import Mapping

import mujoco
import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.signals import TEMP, TIME, A, Q, V
from frictionjoint.identify.segment import Segment
from frictionjoint.mujoco_warnings import became_unstable
from frictionjoint.replay.prescribed_motion import Free, Prescribed
from frictionjoint.simulate.block import ROW
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.mechanism import deflection
from frictionjoint.simulate.motor import Motor
from frictionjoint.simulate.thermal import temperature_setters

# s, length of a run; errors of different runs are independent
RUN_S = 0.5
# s, longest step of a simulation, fine enough for presliding at usual stiffness
LONGEST_STEP = 1e-3


class Windows:
    """One log of one or more driven joints.

    Args:
        model: with the friction of the joints, which acts; all other joints are held.
        segments: the log as prepared for each joint, by name.
        motors: by joint, None where the drive is a torque.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        segments: Mapping[str, Segment],
        motors: Mapping[str, Motor | None],
    ) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        first = next(iter(segments.values()))
        time, self._dt = first.signals[:, TIME], first.dt
        if len(segments) > 1:  # the logs of several joints begin together and have a grid each
            self._dt = min(s.dt for s in segments.values())
            time = np.arange(
                0.0, min(float(s.signals[-1, TIME]) for s in segments.values()), self._dt
            )
        columns = np.stack([_resampled(s, time) for s in segments.values()], axis=-1)
        self._q, self._v, self._a, temperature, self._drive, on, mask = columns
        self._temperature = dict(zip(segments, temperature.T, strict=True))
        self._driven, self._mask = on > 0.5, np.all(mask > 0.999, axis=1)
        self._motors = [(k, m) for k, n in enumerate(segments) if (m := motors[n])]
        self._joints = [model.joint(name).id for name in segments]
        self._links = [j for name in segments if (j := deflection(model, name)) >= 0]
        grid, others = first.signals[:, TIME], first.others
        kinds = ("position", "velocity", "acceleration")
        self._others = {
            n: [np.interp(time, grid, others[f"{n}.{kind}"]) for kind in kinds]
            for n in {x.rpartition(".")[0] for x in others} - set(segments)
            if all(f"{n}.{kind}" in others for kind in kinds)  # others are signals
        }
        self._length = max(2, round(RUN_S / self._dt))
        self._substeps = max(1, int(np.ceil(self._dt / LONGEST_STEP)))

    def errors(self) -> Array:
        """Simulated minus measured position, rad (m), shape (n, joints); NaN where nothing was
        simulated, infinite in a run that became unstable.
        """
        model, data, dt = self._model, self._data, self._dt
        model.opt.timestep = dt / self._substeps
        at, dofs = _addresses(model, self._joints)
        behind, rates = _addresses(model, self._links)
        free = Free(model, data, [*self._joints, *self._links])
        others = Prescribed(model, data, self._others)
        memory, ours = self._memories(), _rows(model)
        part = np.arange(self._substeps)[:, None] / self._substeps
        drives = (1 - part) * self._drive[:-1, None] + part * self._drive[1:, None]
        # every look into `data` makes an array anew
        qpos, qvel, applied = data.qpos, data.qvel, data.qfrc_applied
        errors: Array = np.full(self._q.shape, np.nan)
        for begin in range(0, len(errors) - self._length, self._length):
            if not self._mask[begin : begin + self._length].all():
                continue
            data.time = begin * dt
            qpos[at], qvel[dofs] = self._q[begin], self._v[begin]
            data.userdata[ours], qpos[behind], qvel[rates] = memory[begin // self._length]
            for k in range(begin, begin + self._length - 1):
                if others:
                    others.put(k)
                for torque in drives[k]:
                    for j, motor in self._motors:
                        on, speed = self._driven[k, j], qvel[dofs[j]]
                        torque[j] = motor.torque(torque[j], speed) if on else 0.0
                    if others:
                        free.step(torque)
                        data.time += free.dt
                    else:
                        applied[dofs] = torque
                        mujoco.mj_step(model, data)
                errors[k + 1] = qpos[at] - self._q[k + 1]
            if became_unstable(data):
                errors[begin + 1 : begin + self._length] = np.inf
                mujoco.mj_resetData(model, data)
        return errors

    def _memories(self) -> list[tuple[Array, Array, Array]]:
        """State rows at the restarts, from the callback driven along the measured motion.

        Each comes with position and velocity of the joints behind elastic ones, which are driven
        along as well.
        """
        model, data, found = self._model, self._data, []
        free, ours = Free(model, data, self._links) if self._links else None, _rows(model)
        # samples, not steps of a simulation: after a gap of several steps the memory starts afresh
        step, model.opt.timestep = model.opt.timestep, self._dt
        at, dofs = _addresses(model, self._joints)
        behind, rates = _addresses(model, self._links)
        qpos, qvel = data.qpos, data.qvel
        for k, (q, v, a) in enumerate(zip(self._q, self._v, self._a, strict=True)):
            data.time = k * self._dt
            qpos[at], qvel[dofs] = q, v
            if k == 0:
                mujoco.mj_forward(model, data)
                setters = temperature_setters(model, data)
            else:
                mujoco.mj_fwdPosition(model, data)
                mujoco.mj_fwdVelocity(model, data)
            if k % self._length == 0:
                for name, put in setters.items():
                    put(self._temperature[name][k])
                found.append((data.userdata[ours].copy(), qpos[behind], qvel[rates]))
            if free:
                data.qacc[dofs] = a
                for _ in range(self._substeps):
                    free.step(np.zeros(0))
        model.opt.timestep = step
        return found


def _resampled(s: Segment, time: Array) -> Array:
    """Position and its derivatives, temperature, drive, whether it acts, and mask, (7, n)."""
    columns = (*(s.signals[:, k] for k in (Q, V, A, TEMP)), s.drive, s.driven, s.mask)
    return np.array([np.interp(time, s.signals[:, TIME], x.astype(float)) for x in columns])


def _addresses(model: mujoco.MjModel, joints: list[int]) -> tuple[Index, Index]:
    # indices of numpy's own type are looked up three times as fast
    return model.jnt_qposadr[joints].astype(int), model.jnt_dofadr[joints].astype(int)


def _rows(model: mujoco.MjModel) -> slice:
    """The user data that contain the friction memory of all joints."""
    rows = (int(model.numeric_data[block + ROW]) for block in resolve(model).values())
    return slice(min(rows), model.nuserdata)
