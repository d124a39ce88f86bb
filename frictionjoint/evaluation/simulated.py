"""Simulated positions: in short runs from measured states, and in closed loop."""

from collections.abc import Mapping

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import COUNT, STATE, tick
from frictionjoint.control.profile import held
from frictionjoint.control.reconstruct import commands
from frictionjoint.evaluation.model import EvaluatedModel
from frictionjoint.evaluation.recording import Recording
from frictionjoint.evaluation.torque import STATE as FULL
from frictionjoint.evaluation.torque import Along
from frictionjoint.measured.derivatives import first_velocity
from frictionjoint.mujoco_warnings import became_unstable
from frictionjoint.replay.prescribed_motion import Prescribed


def replay(m: EvaluatedModel, recording: Recording, along: Along) -> dict[str, Array]:
    """Position error of simulations that start from measured states and receive the measured drive.

    Returns:
        simulated minus measured position by joint, rad or m, shape (n,); NaN where not simulated.
    """
    model, data = m.model, mujoco.MjData(m.model)
    led = Prescribed(model, data, recording.led)
    n, every = len(recording.time), along.every
    torques = np.stack(
        [recording.drive[x] if m.controls[x] is None else np.zeros(n) for x in m.joints], axis=1
    )
    controls = {i: recording.drive[name] for name, i in m.controls.items() if i is not None}
    measured = np.stack([recording.motion[name][0] for name in m.joints], axis=1)
    known = np.all([recording.known[name] for name in m.joints], axis=0)
    errors = np.full((n, len(m.joints)), np.nan)
    with m.acting():
        for w, begin in enumerate(range(0, n - every, every)):
            if not known[begin : begin + every].all():
                continue
            mujoco.mj_resetData(model, data)
            mujoco.mj_setState(model, data, along.states[w], FULL)
            for k in range(begin, begin + every):
                data.qfrc_applied[m.dofs] = 0.5 * (torques[k] + torques[k + 1])
                for i, drive in controls.items():
                    data.ctrl[i] = 0.5 * (drive[k] + drive[k + 1])
                mujoco.mj_step(model, data)
                led.put(k + 1)
                errors[k + 1] = data.qpos[m.qpos] - measured[k + 1]
            if became_unstable(data):
                errors[begin + 1 : begin + every + 1] = np.inf
    return dict(zip(m.joints, errors.T, strict=True))


def closed_loop(
    m: EvaluatedModel, recording: Recording, controllers: Mapping[str, Controller]
) -> dict[str, Array]:
    """Simulate a log from its target, with a controller for every joint that is evaluated.

    Returns:
        simulated position by joint, at the times of the recording, shape (n,).
    """
    model, data = m.model, mujoco.MjData(m.model)
    led, n = Prescribed(model, data, recording.led), len(recording.time)
    loops = [_Loop(m, recording, name, controllers[name]) for name in m.joints]
    position = np.empty((n, len(loops)))
    for loop in loops:
        loop.begin(data)
    led.put(0)
    with m.acting():
        mujoco.mj_forward(model, data)
        for k in range(n):
            position[k] = data.qpos[m.qpos]
            for loop in loops:
                loop.drive(data, k)
            mujoco.mj_step(model, data)
            led.put(min(k + 1, n - 1))
            if became_unstable(data):
                position[k:] = np.inf
                break
    return dict(zip(m.joints, position.T, strict=True))


class _Loop:
    """The controller of one joint in a simulation."""

    def __init__(
        self, m: EvaluatedModel, recording: Recording, joint: str, controller: Controller
    ) -> None:
        log = recording.logs[joint]
        given = commands(log, controller)
        self._block, self._state = given.block, np.zeros(STATE)
        # the nearest sample, so that jitter of nanoseconds does not delay a value by one sample
        now = recording.time + log.time[0] + 0.5 * recording.step
        self._time = recording.time
        self._target = held(log.time, given.target, now - given.delay)
        self._supply = held(log.time, given.supply, now)
        self._on = held(log.time, given.on.astype(float), now) > 0.5
        self._control = m.controls[joint]
        k = m.joints.index(joint)
        self._at, self._dof = int(m.qpos[k]), int(m.dofs[k])
        start = first_velocity(log.time, log.position, float(self._block[COUNT]))
        self._start = float(log.position[0]), start

    def begin(self, data: mujoco.MjData) -> None:
        data.qpos[self._at], data.qvel[self._dof] = self._start

    def drive(self, data: mujoco.MjData, k: int) -> None:
        q, v = float(data.qpos[self._at]), float(data.qvel[self._dof])
        inputs = float(self._target[k]), q, v, float(self._supply[k])
        u = tick(self._block, self._state, float(self._time[k]), *inputs)
        u = u if self._on[k] else 0.0
        if self._control is None:
            data.qfrc_applied[self._dof] = u
        else:
            data.ctrl[self._control] = u
