"""The torque that a model requires along a measured motion, and its states on the way.

The torque is MuJoCo's inverse dynamics of the model with all its friction. Friction states, of this
package and of MuJoCo, and links behind springs or gaps are integrated along the motion.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.evaluation.model import EvaluatedModel
from frictionjoint.evaluation.recording import Recording
from frictionjoint.model_joints import count_of_actuators
from frictionjoint.replay.prescribed_motion import Free, Prescribed
from frictionjoint.simulate.thermal import temperature_setters

# an explicit integrator, so that friction gives the torque at the present time, not at the end of
# the step
_EXPLICIT = int(mujoco.mjtIntegrator.mjINT_RK4)
# the stage up to which a forward pass has come
_VELOCITY = int(mujoco.mjtStage.mjSTAGE_VEL)
_NO_TORQUE: Array = np.zeros(0)
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
    """Compute the torque that a model needs along a recording, at the measured temperatures, and
    states `every` samples apart."""
    model, data = m.model, mujoco.MjData(m.model)
    own_integrator = model.opt.integrator
    moved = Prescribed(model, data, recording.motion | recording.led)
    links = Free(model, data, m.links) if m.links else None
    # the torque of limits in a measured motion is unknown, but for the flanks of a gap
    limited = model.jnt_limited, model.tendon_limited
    every_limit, flanks = [x.copy() for x in limited], [np.zeros_like(x) for x in limited]
    flanks[0][m.links] = every_limit[0][m.links]
    n = len(recording.time)
    needed, acting = np.empty((n, len(m.joints))), np.zeros((n, len(m.joints)))
    drives = [(i, recording.drive[name]) for name, i in m.controls.items() if i is not None]
    # every look into `data` makes an array anew
    control, qacc = data.ctrl, data.qacc
    inverse, actuator = data.qfrc_inverse, data.qfrc_actuator
    acts, dofs, states = count_of_actuators(model) > 0, m.dofs, []
    # states that must be integrated: activations, plasticity
    remembers = bool(model.na or getattr(model, "nplastic", 0))
    heats: list[tuple[Callable[[float], None], Array]] = []
    with m.acting():
        model.opt.integrator = _EXPLICIT
        _put(limited, flanks)
        for k, time in enumerate(recording.time.tolist()):
            data.time = time
            moved.put(k)
            for i, drive in drives:
                control[i] = drive[k]
            if k % every == 0:
                _put(limited, every_limit)
                mujoco.mj_forward(model, data)
                if k == 0:
                    setters = temperature_setters(model, data)
                    heats = [
                        (setters[n], x) for n, x in recording.temperature.items() if n in setters
                    ]
                _heat(heats, k)
                states.append(np.empty(mujoco.mj_stateSize(model, STATE)))
                mujoco.mj_getState(model, data, states[-1], STATE)
                qacc[:] = 0.0
                moved.put(k)
                _put(limited, flanks)
            else:
                _heat(heats, k)
            if links:
                links.accelerate(_NO_TORQUE)
            if acts:
                mujoco.mj_fwdPosition(model, data)
                mujoco.mj_fwdVelocity(model, data)
                mujoco.mj_fwdActuation(model, data)
                mujoco.mj_inverseSkip(model, data, _VELOCITY, 1)
                acting[k] = actuator[dofs]
            else:
                mujoco.mj_inverse(model, data)
            needed[k] = inverse[dofs]
            if remembers:
                _put(limited, every_limit)
                model.opt.integrator = own_integrator
                now = data.qpos.copy(), data.qvel.copy(), qacc.copy()
                mujoco.mj_step(model, data)
                data.qpos[:], data.qvel[:], qacc[:] = now
                model.opt.integrator = _EXPLICIT
                _put(limited, flanks)
            if links:
                links.advance()
    given = np.array([m.controls[name] is not None for name in m.joints]) * acting
    needed -= acting - given
    _put(limited, every_limit)
    model.opt.integrator = own_integrator
    torques, acted = (dict(zip(m.joints, x.T, strict=True)) for x in (needed, given))
    return Along(torques, acted, states, every)


def _heat(heats: Sequence[tuple[Callable[[float], None], Array]], k: int) -> None:
    """Set the measured temperatures of sample k."""
    for put, celsius in heats:
        put(float(celsius[k]))


def _put(arrays: Sequence[NDArray[Any]], values: Sequence[NDArray[Any]]) -> None:
    for own, value in zip(arrays, values, strict=True):
        own[:] = value
