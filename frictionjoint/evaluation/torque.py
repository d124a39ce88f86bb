"""The torque that a model requires along a measured motion, and its states on the way.

The torque is MuJoCo's inverse dynamics of the model with all its friction. Friction states, of this
package and of MuJoCo, are integrated along the motion.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.evaluation.model import EvaluatedModel
from frictionjoint.evaluation.recording import Recording
from frictionjoint.replay.prescribed_motion import Prescribed

# an explicit integrator, so that friction gives the torque at the present time, not at the end of
# the step
_EXPLICIT = int(mujoco.mjtIntegrator.mjINT_RK4)
STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)


@dataclass(frozen=True)
class Along:
    """Torques and states of a model along the motion of a recording.

    Attributes:
        needed: torque that must act on each joint, N m or N, shape (n,).
        given: torque that each joint's actuator delivers for its control, shape (n,); zero for a
            joint whose log contains the torque.
        states: full state of MuJoCo at samples 0, `every`, 2 `every` ...
    """

    needed: dict[str, Array]
    given: dict[str, Array]
    states: list[Array]
    every: int


def torque_along(m: EvaluatedModel, recording: Recording, every: int) -> Along:
    """Compute the torque that a model needs along a recording.

    Args:
        every: a full state is stored at every `every`-th sample.
    """
    model, data = m.model, mujoco.MjData(m.model)
    before = model.opt.timestep, model.opt.integrator, model.opt.disableflags
    model.opt.timestep = recording.step
    q, v, a = (np.stack([recording.motion[n][i] for n in m.joints], axis=1) for i in range(3))
    led = Prescribed(model, data, recording.led)
    n = len(recording.time)
    needed, given = np.empty((n, len(m.joints))), np.zeros((n, len(m.joints)))
    controls = {i: recording.drive[name] for name, i in m.controls.items() if i is not None}
    own = [k for k, name in enumerate(m.joints) if m.controls[name] is not None]
    free = [k for k in range(len(m.joints)) if k not in own]
    acts, remembers, states = m.acts, m.remembers, []
    qpos, qvel, qacc, inverse = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
    with m.acting():
        model.opt.integrator = _EXPLICIT
        _without_limits(model, True)
        for k in range(n):
            data.time = recording.time[k]
            qpos[m.qpos], qvel[m.dofs], qacc[m.dofs] = q[k], v[k], a[k]
            led.put(k)
            for i, drive in controls.items():
                data.ctrl[i] = drive[k]
            if k % every == 0:
                _without_limits(model, False)
                mujoco.mj_forward(model, data)
                states.append(_state(model, data))
                qacc[:] = 0.0
                qacc[m.dofs] = a[k]
                led.put(k)
                _without_limits(model, True)
            if acts:
                mujoco.mj_fwdPosition(model, data)
                mujoco.mj_fwdVelocity(model, data)
                mujoco.mj_fwdActuation(model, data)
            mujoco.mj_inverse(model, data)
            needed[k] = inverse[m.dofs]
            if acts:
                acting = data.qfrc_actuator[m.dofs]
                needed[k, free] -= acting[free]
                given[k, own] = acting[own]
            if remembers:
                _without_limits(model, False)
                model.opt.integrator = before[1]
                mujoco.mj_step(model, data)
                model.opt.integrator = _EXPLICIT
                _without_limits(model, True)
    model.opt.timestep, model.opt.integrator, model.opt.disableflags = before
    return Along(
        dict(zip(m.joints, needed.T, strict=True)),
        dict(zip(m.joints, given.T, strict=True)),
        states,
        every,
    )


def _without_limits(model: mujoco.MjModel, off: bool) -> None:
    """Disable joint limits, whose torque in a measured motion is unknown, or enable them."""
    bit = int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    model.opt.disableflags = model.opt.disableflags | bit if off else model.opt.disableflags & ~bit


def _state(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    found = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, found, STATE)
    return found
