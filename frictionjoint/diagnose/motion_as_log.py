"""Proposed motions as logs of them would be, and the payloads that they carry."""

import itertools
from dataclasses import replace

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.motions import Limits, Motion
from frictionjoint.effects.signals import (
    DT,
    GEAR,
    GX,
    GY,
    LOAD,
    N_SIGNALS,
    SAG,
    SWAY,
    TEMP,
    TIME,
    A,
    Q,
    V,
)
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared, Segment


class Carried:
    """Rigid-body torque while only this joint moves: M(q) a + c(q) v^2 + g(q).

    Args:
        body: of the MJCF. like: the logs; other joints stay at their median positions.
        limits: range of positions in the lookup table.
    """

    def __init__(self, body: RigidBody, like: Prepared, limits: Limits) -> None:
        self.q = np.linspace(limits.low, limits.high, 257)
        none, one = np.zeros_like(self.q), np.ones_like(self.q)
        others = {}
        for name in body.joint_names:
            key = f"{name}.position"
            tracks = [s.others[key] for s in like.segments if key in s.others]
            if tracks:
                others[name] = (none + np.median(np.concatenate(tracks)), none, none)
        still = body.torque(self.q, none, none, others)
        self.gravity, self.gx, self.gy = still.load, still.gx, still.gy
        self.sag, self.sway = still.sag, still.sway
        self.inertia = still.inertia
        self.centrifugal = body.torque(self.q, one, none, others).load - still.load
        self.armature = body.armature

    def fill(self, signals: Array, payload: float) -> None:
        """Rigid-body signals of a motion, shape (n, N_SIGNALS), including Q, V and A.

        Args:
            payload: fraction of the carried load to add.
        """
        q, v, a = (signals[:, k] for k in (Q, V, A))

        def at(column: Array) -> Array:
            return np.asarray(np.interp(q, self.q, column))

        load = at(self.inertia) * a + at(self.centrifugal) * v**2 + at(self.gravity)
        gear = load - self.armature * a
        signals[:, LOAD] = load + payload * gear
        signals[:, GEAR] = gear + payload * gear
        signals[:, GX], signals[:, GY] = at(self.gx), at(self.gy)
        signals[:, SAG], signals[:, SWAY] = at(self.sag), at(self.sway)


def prepared_motion(motion: Motion, like: Prepared, carried: Carried) -> Prepared:
    """A motion prepared as a log of it would be, with zero drive.

    Args:
        like: the logs. carried: for the limits of the motion.
    """
    dt, n = motion.dt, len(motion.position)
    bandwidth = min(like.segments[0].bandwidth_hz, 0.25 / dt)
    signals = np.zeros((n, N_SIGNALS))
    signals[:, TIME] = dt * np.arange(n)
    signals[:, Q] = motion.position
    for lower, higher in itertools.pairwise((Q, V, A)):
        signals[:, higher] = np.gradient(signals[:, lower], dt)
    carried.fill(signals, motion.payload)
    signals[1:, DT] = dt
    signals[:, TEMP] = np.nan if motion.temperature is None else motion.temperature
    edge = max(2, int(1.0 / (bandwidth * dt)))
    mask = np.ones(n, dtype=bool)
    mask[:edge] = mask[n - edge :] = False
    first = like.segments[0]
    segment = Segment(
        name=motion.name,
        dt=dt,
        bandwidth_hz=bandwidth,
        step=1,
        signals=signals,
        drive=np.zeros(n),
        driven=np.ones(n, dtype=bool),
        mask=mask,
        others={},
        noise=first.noise,
        sample=first.sample,
        corner_hz=first.corner_hz,
    )
    return replace(like, segments=(segment,))


def payload_of(motion: Motion, body: RigidBody) -> str:
    """The payload of a motion as text: a mass and where to attach it.

    It is a point mass that raises the first and second moment of the carried load at qpos0 by the
    fraction `motion.payload`.
    """
    model, data = body.model, mujoco.MjData(body.model)
    mujoco.mj_forward(model, data)
    child = int(model.jnt_bodyid[body.joint_id])
    mass = float(model.body_subtreemass[child])
    if body.slide:
        return f"payload of {motion.payload * mass:.2g} kg"
    dof = int(model.jnt_dofadr[body.joint_id])
    inertia = float(data.M[model.M_rowadr[dof] + model.M_rownnz[dof] - 1] - model.dof_armature[dof])
    axis = data.xaxis[body.joint_id]
    arm = data.subtree_com[child] - data.xanchor[body.joint_id]
    away = float(np.linalg.norm(arm - (arm @ axis) * axis))
    # of the inertia next to nothing comes from the distance of the centre of mass
    if away**2 * mass < 0.05 * inertia:
        return f"payload balanced about the axis, {motion.payload * inertia:.2g} kg m^2"
    # m r and m r^2 of the point mass
    first = motion.payload * mass * away
    r = motion.payload * inertia / first
    return f"payload of {first / r:.2g} kg at {r:.2g} m from the axis"
