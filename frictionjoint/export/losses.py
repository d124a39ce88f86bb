"""Losses of an export: error of the torque along a motion, and of a control loop.

Both friction torques are MuJoCo's own: inverse dynamics of the model with friction and of the
exported one, minus that of the model without. The control loop is the same in both, and soft so
that friction matters: friction alone displaces the joint by a tenth of the motion's range. Its
damping ratio is 0.3, gravity and the desired acceleration are compensated, other joints are
held.
"""

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.errors import ModelError
from frictionjoint.export.motion import Motion
from frictionjoint.model_files import ONE_DOF
from frictionjoint.model_joints import is_slide, mass_at_start
from frictionjoint.replay.prescribed_motion import Prescribed
from frictionjoint.simulate.attach import attach

# its steps are never implicit: torque is wanted here and now, not at a step's end
_EXPLICIT = int(mujoco.mjtIntegrator.mjINT_RK4)
_ROBOT = 1  # an actuator group


@dataclass(frozen=True)
class Loss:
    """Losses of one joint along one motion, by their names.

    Attributes:
        torque: rms of the friction torque. torque_lost: rms of its error after the export.
        sliding_lost: the same in sliding alone, away from rest and reversals; None: no sliding.
        error: rms position error of the loop with our friction, rad (m). error_exported: with the
            exported one. apart: rms difference of the two runs.
    """

    joint: str
    motion: str
    unit: str
    torque: float
    torque_lost: float
    sliding_lost: float | None
    error: float
    error_exported: float
    apart: float

    @property
    def unit_of_position(self) -> str:
        """rad, or m for a slide."""
        return "m" if self.unit == "N" else "rad"


def losses(
    ours: mujoco.MjModel,
    bare: mujoco.MjModel,
    exported: mujoco.MjModel,
    motions: Mapping[str, Motion],
    actuators: Mapping[str, Array],
    presliding: Mapping[str, float],
) -> list[Loss]:
    """The losses of each joint along its motion.

    Args:
        ours: the model with friction. bare: the model without friction.
        exported: the model with the exported friction; the actuators that it adds are active. Flags
            and time steps of all three are changed.
        actuators: torque along the motion, by joint, of actuators that represent friction and are
            unknown to inverse dynamics; shape (n,).
        presliding: distance from a reversal beyond which a joint slides, rad (m).
    Raises:
        ModelError: the exported model diverges in the loop.
    """
    for model in (ours, bare, exported):
        _alone(model, len(bare.actuator_group))
    found = []
    for joint, motion in motions.items():
        base = _inverse(bare, joint, motion, False)
        here = _inverse(ours, joint, motion, True) - base
        there = _inverse(exported, joint, motion, False) - base + actuators.get(joint, 0.0)
        stiffness = root_mean_square(here) / (0.1 * float(np.ptp(motion.position)))
        run = _loop(ours, bare, joint, motion, stiffness, True)
        other = _loop(exported, bare, joint, motion, stiffness, False)
        if not np.isfinite(other).all():
            raise ModelError(
                f"joint {joint!r}: the exported model diverges at a time step of "
                f"{exported.opt.timestep:g} s, take a smaller one"
            )
        sliding = motion.from_reversal > presliding[joint]
        found.append(
            Loss(
                joint=joint,
                motion=motion.name,
                unit="N" if is_slide(ours, joint) else "N m",
                torque=root_mean_square(here),
                torque_lost=root_mean_square(there - here),
                sliding_lost=root_mean_square((there - here)[sliding]) if sliding.any() else None,
                error=root_mean_square(run - motion.position),
                error_exported=root_mean_square(other - motion.position),
                apart=root_mean_square(other - run),
            )
        )
    return found


def _tracks(model: mujoco.MjModel, joint: str, motion: Motion) -> dict[str, list[Array]]:
    """Position, velocity and acceleration along the motion by joint, shape (n,) each."""
    dt = float(motion.time[1] - motion.time[0])
    found = {joint: [motion.position, motion.velocity, motion.acceleration]}
    for name, q in motion.others.items():
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0:
            v = np.gradient(q, dt)
            found[name] = [q, v, np.gradient(v, dt)]
    return found


def _alone(model: mujoco.MjModel, actuators: int) -> None:
    """Disable contacts, limits and the robot's actuators, which are the first `actuators`."""
    off = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.opt.disableflags |= int(off)
    model.actuator_group[:actuators] = _ROBOT
    model.actuator_group[actuators:] = 0
    model.opt.disableactuator = 1 << _ROBOT


def _inverse(model: mujoco.MjModel, joint: str, motion: Motion, attached: bool) -> Array:
    """Torque at the joint that the motion requires, shape (n,)."""
    data, before = mujoco.MjData(model), (model.opt.timestep, model.opt.integrator)
    moved = Prescribed(model, data, _tracks(model, joint, motion))
    dof = int(model.jnt_dofadr[model.joint(joint).id])
    found = np.empty(len(motion.time))
    model.opt.timestep, model.opt.integrator = motion.time[1] - motion.time[0], _EXPLICIT
    with attach(model) if attached else contextlib.nullcontext():
        for k, t in enumerate(motion.time):
            data.time = t
            # a step below moves the other joints too
            data.qpos[:], data.qvel[:], data.qacc[:] = model.qpos0, 0.0, 0.0
            moved.put(k)
            mujoco.mj_inverse(model, data)
            found[k] = data.qfrc_inverse[dof]
            if getattr(model, "nplastic", 0):  # springs that yield are carried on by steps alone
                model.opt.integrator = before[1]
                mujoco.mj_step(model, data)
                model.opt.integrator = _EXPLICIT
    model.opt.timestep, model.opt.integrator = before
    return found


def _loop(
    model: mujoco.MjModel,
    bare: mujoco.MjModel,
    joint: str,
    motion: Motion,
    stiffness: float,
    attached: bool,
) -> Array:
    """Position of the joint in a loop with this stiffness, N m/rad, at the motion's times."""
    data, before = mujoco.MjData(model), model.opt.timestep
    driven = [j for j in range(model.njnt) if model.jnt_type[j] in ONE_DOF]
    qpos, dofs = model.jnt_qposadr[driven], model.jnt_dofadr[driven]
    steps = max(1, int(np.ceil(motion.time[-1] / before)))
    model.opt.timestep = motion.time[-1] / steps
    time = model.opt.timestep * np.arange(steps + 1)
    wanted = np.zeros((3, steps + 1, len(driven)))
    wanted[0] = model.qpos0[qpos]
    for name, track in _tracks(model, joint, motion).items():
        own = driven.index(model.joint(name).id)
        wanted[:, :, own] = [np.interp(time, motion.time, x) for x in track]
    j = model.joint(joint).id
    mass = mass_at_start(bare)[np.ix_(dofs, dofs)]
    free = 1.0 / np.diag(np.linalg.inv(mass))  # inertia where the other joints are free
    springs = (2.0 * np.pi * 3.0) ** 2 * np.diag(mass)  # 3 Hz hold the other joints
    # an explicit spring must not chatter: at most 0.3 rad per time step
    own = driven.index(j)
    springs[own] = min(stiffness, free[own] * (0.3 / model.opt.timestep) ** 2)
    dampers = 2.0 * 0.3 * np.sqrt(springs * free)
    data.qpos[qpos], data.qvel[dofs] = wanted[0, 0], wanted[1, 0]
    found = np.empty(steps + 1)
    with attach(model) if attached else contextlib.nullcontext():
        mujoco.mj_forward(model, data)
        for k in range(steps + 1):
            found[k] = data.qpos[model.jnt_qposadr[j]]
            data.qfrc_applied[:] = data.qfrc_bias
            data.qfrc_applied[dofs] += (
                springs * (wanted[0, k] - data.qpos[qpos])
                + dampers * (wanted[1, k] - data.qvel[dofs])
                + mass @ wanted[2, k]
            )
            mujoco.mj_step(model, data)
    model.opt.timestep = before
    return np.interp(motion.time, time, found)
