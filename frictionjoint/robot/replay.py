"""Free runs of a whole robot: every joint driven by its measured torque at once.

As for a single joint, all joints are set to their measured states every half second, with the
friction memory that the laws have after the motion so far, and the robot runs freely until the next
restart. Joints without a drive follow their measured motion, or stay.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import TIME, Q, V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.held import lock, take_pose
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.mujoco_warnings import became_unstable, unheard
from frictionjoint.replay.free_runs import WINDOW_S, motor_of
from frictionjoint.robot.logs import Place, by_place
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.mechanism import deflection

_LONGEST_STEP = 1e-3


@dataclass(frozen=True)
class _Track:
    """A joint on the common grid: position, velocity, drive, each of shape (n,)."""

    q: Array
    v: Array
    drive: Array | None
    mask: Array


def replay_robot(
    spec: mujoco.MjSpec,
    joints: Mapping[str, tuple[Prepared, Fit]],
    poses: Mapping[str, Array],
) -> float | None:
    """rms position error of all joints with a drive, rad (m).

    Args:
        spec: the robot with every joint's friction. joints: logs and fit by name.
        poses: positions of joints that no log contains, by name.
    Returns:
        None if there is no run, or if the runs leave the measured motion.
    """
    model = spec.compile()
    take_pose(model, {model.joint(name).id: pose for name, pose in poses.items()})
    logs: dict[Place, dict[str, Segment]] = {}
    for name, (prepared, _) in joints.items():
        for place, segment in by_place(prepared.segments).items():
            logs.setdefault(place, {})[name] = segment
    seen = [s.others for segments in logs.values() for s in segments.values()]
    moving = [
        n for n in {x.rpartition(".")[0] for others in seen for x in others} if _has(model, n)
    ]
    behind = [deflection(model, name) for name in joints]
    lock(model, *(model.joint(n).id for n in (*joints, *moving)), *behind)
    off = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.opt.disableflags |= int(off)
    errors: list[Array] = []
    with attach(model), unheard():
        for segments in logs.values():
            errors.append(_one_log(model, segments, {n: f for n, (_, f) in joints.items()}, moving))
    e = np.concatenate(errors)
    e = e[~np.isnan(e)]
    travel = max(float(np.ptp(s.signals[:, Q])) for p, _ in joints.values() for s in p.segments)
    rms = root_mean_square(e) if e.size else np.inf
    return rms if rms <= travel else None


def _has(model: mujoco.MjModel, joint: str) -> bool:
    return bool(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint) >= 0)


def _one_log(
    model: mujoco.MjModel,
    segments: Mapping[str, Segment],
    fits: Mapping[str, Fit],
    moving: Sequence[str],
) -> Array:
    dt = min(s.dt for s in segments.values())
    end = min(float(s.signals[-1, TIME]) for s in segments.values())
    time = np.arange(0.0, end, dt)
    tracks = _tracks(time, segments, moving)
    data = mujoco.MjData(model)
    names = list(tracks)
    at = [int(model.joint(n).qposadr[0]) for n in names]
    dofs = [int(model.joint(n).dofadr[0]) for n in names]
    q, v = (np.column_stack([getattr(tracks[n], key) for n in names]) for key in ("q", "v"))
    length = max(2, round(WINDOW_S / dt))
    rows = _memories(model, data, (at, dofs), q, v, dt, length)
    substeps = max(1, int(np.ceil(dt / _LONGEST_STEP)))
    model.opt.timestep = dt / substeps
    driven = [k for k, n in enumerate(names) if tracks[n].drive is not None]
    led = [k for k in range(len(names)) if k not in driven]
    drives = np.column_stack([x for n in names if (x := tracks[n].drive) is not None])
    motors = [motor_of(fits[names[k]]) for k in driven]
    masks = np.all([t.mask for t in tracks.values()], axis=0)
    errors = np.full((len(time), len(driven)), np.nan)
    own = [at[k] for k in driven]
    for begin in range(0, len(time) - length, length):
        if not masks[begin : begin + length].all():
            continue
        mujoco.mj_resetData(model, data)
        data.time = begin * dt
        data.qpos[at], data.qvel[dofs] = q[begin], v[begin]
        data.userdata[:] = rows[begin // length]
        for k in range(begin, begin + length - 1):
            for i in range(substeps):
                part = i / substeps
                torque = (1.0 - part) * drives[k] + part * drives[k + 1]
                for m, (motor, joint) in enumerate(zip(motors, driven, strict=True)):
                    if motor:
                        torque[m] = motor.torque(torque[m], data.qvel[dofs[joint]])
                data.qfrc_applied[[dofs[joint] for joint in driven]] = torque
                mujoco.mj_step(model, data)
            for joint in led:
                data.qpos[at[joint]], data.qvel[dofs[joint]] = q[k + 1, joint], v[k + 1, joint]
            errors[k + 1] = data.qpos[own] - q[k + 1, driven]
        if became_unstable(data):
            errors[begin + 1 : begin + length] = np.inf
    return errors.ravel()


def _tracks(
    time: Array, segments: Mapping[str, Segment], moving: Sequence[str]
) -> dict[str, _Track]:
    found = {}
    for name, s in segments.items():
        t = s.signals[:, TIME]
        q, v, drive = (np.interp(time, t, x) for x in (s.signals[:, Q], s.signals[:, V], s.drive))
        driven = np.interp(time, t, s.driven.astype(float)) > 0.5
        mask = np.interp(time, t, s.mask.astype(float)) > 0.999
        found[name] = _Track(q, v, drive * driven, mask)
    first = next(iter(segments.values()))
    t = first.signals[:, TIME]
    for name in moving:
        if name not in found and f"{name}.position" in first.others:
            q, v = (np.interp(time, t, first.others[f"{name}.{k}"]) for k in _KINDS)
            found[name] = _Track(q, v, None, np.ones(len(time), dtype=bool))
    return found


_KINDS = ("position", "velocity")


def _memories(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    places: tuple[list[int], list[int]],
    q: Array,
    v: Array,
    dt: float,
    length: int,
) -> list[Array]:
    """State rows at the restarts: the callback driven along the measured motion."""
    rows = []
    at, dofs = places
    # samples, not steps of a simulation: a gap of several time steps would start the memory afresh
    step, model.opt.timestep = model.opt.timestep, dt
    for k in range(len(q)):
        data.time = k * dt
        data.qpos[at], data.qvel[dofs] = q[k], v[k]
        if k == 0:
            mujoco.mj_forward(model, data)
        else:
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
        if k % length == 0:
            rows.append(data.userdata.copy())
    model.opt.timestep = step
    return rows
