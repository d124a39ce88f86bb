"""Rigid-body torque at one joint along a measured motion, from the user's own MJCF.

It uses MuJoCo's inverse dynamics. Contacts, limits and all friction or damping of the joint in the
MJCF are left out, because friction is identified; samples at a limit are reported. Coulomb friction
of tendons between joints, whose level may vary along a shaft, stays in the model: it is part of the
load, except while the tendon stands still, when its torque is unknown.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError, few
from frictionjoint.identify.fixed_joints import Pose, joint_label, resolve, take_pose
from frictionjoint.measured.arguments import expect
from frictionjoint.model_files import ONE_DOF, compile_model, read_spec
from frictionjoint.model_text import model_text
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.native_friction import native_friction
from frictionjoint.simulate.shaft_wave import wave_blocks, wave_level
from frictionjoint.simulate.uninstall import carrying, take_out

# part of a tendon's top speed over which its friction turns over
TURNS = 0.01


@dataclass(frozen=True)
class RigidBodyTorque:
    """Rigid-body torque along a motion, each of shape (n,); of gravity, zero for a slide joint."""

    load: Array  # torque that the rigid body needs at the joint, N m (N for a slide)
    # gravity of 1 kg at 1 m along the child body's two axes across the joint, N m per kg m
    gx: Array
    gy: Array
    sag: Array  # gravity torque of the link over its inertia, without the armature, rad/s^2
    sway: Array  # derivative of `sag` by the position, 1/s^2
    inertia: Array  # about the joint's axis, with the joint's armature, kg m^2 (kg)
    # root of the sum of squares of the torques per acceleration of each joint that moves, with the
    # joint's own, kg m^2 (kg)
    coupling: Array
    unknown: Array | None = None  # friction outside of the joint that no motion determines, N m


class RigidBody:
    """The MJCF around one hinge or slide joint.

    Args:
        mjcf: path of the MJCF, or its text.
        joint: name of the examined joint.
        fixed: positions of other joints by name, see `fixed_joints.Pose`; others without a log
            stay at its initial position, qpos0.
    Attributes:
        mjcf: without friction of an earlier run at the joint. carried: whether it had some.
        native: friction of the joint in the MJCF, in words; empty for none.
        joint_names: of the other hinges and slides. poses: of the fixed joints, by index.
    Raises:
        ModelError: the file does not compile, or has no such hinge or slide joint; a bad position.
        TypeError: not a path or text, or not a name.
    """

    def __init__(
        self, mjcf: str | Path, joint: str, fixed: Mapping[str, Pose] | None = None
    ) -> None:
        expect(mjcf, (str, Path), "model", "give the path of an MJCF, or its text")
        expect(joint, str, "joint", "give its name in the MJCF")
        expect(fixed, (Mapping, type(None)), "fixed", 'give poses by name, {"shoulder": 0.3}')
        self.mjcf = mjcf
        self.model = compile_model(mjcf)
        self.carried = joint in blocks(self.model)
        if self.carried:
            self.mjcf, _ = before_friction(mjcf, [joint])
            self.model = compile_model(self.mjcf)
        self.joint = joint
        self.joint_id = _joint_id(self.model, joint)
        _require_uncoupled(self.model, self.joint_id)
        self.poses = resolve(self.model, self.joint_id, fixed)
        take_pose(self.model, self.poses)
        others = [j for j in range(self.model.njnt) if j != self.joint_id]
        one_dof = (self.model.joint(j).name for j in others if self.model.jnt_type[j] in ONE_DOF)
        self.joint_names = {name for name in one_dof if name}
        self.slide = int(self.model.jnt_type[self.joint_id]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
        off = (
            mujoco.mjtDisableBit.mjDSBL_CONTACT
            | mujoco.mjtDisableBit.mjDSBL_LIMIT
            | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
        )
        self.model.opt.disableflags |= int(off)
        self.native = native_friction(self.model, [joint]).get(joint, "")
        dof = self.model.jnt_dofadr[self.joint_id]
        self.model.dof_damping[dof] = 0.0
        if hasattr(self.model, "dof_dampingpoly"):  # damping="0 0.5", in newer versions
            self.model.dof_dampingpoly[dof] = 0.0
        self.armature = float(self.model.dof_armature[dof])

    @property
    def limits(self) -> tuple[float, float]:
        """Positions at which the joint's limits begin to act, rad (m); infinite: none."""
        j, margin = self.joint_id, float(self.model.jnt_margin[self.joint_id])
        if not self.model.jnt_limited[j]:
            return -np.inf, np.inf
        low, high = self.model.jnt_range[j]
        return float(low) + margin, float(high) - margin

    def beyond_limits(self, position: Array) -> Array:
        """How far the joint is beyond its nearer limit, rad (m), negative inside, shape (n,)."""
        low, high = self.limits
        return np.maximum(low - position, position - high)

    def at_limit(self, position: Array) -> NDArray[np.bool_]:
        """Whether the joint is at a limit, whose torque no motion determines, shape (n,); False
        everywhere if it moves far beyond the limit, which is another joint's or has another zero.
        """
        low, high = self.limits
        beyond = self.beyond_limits(position)
        # a limit may yield by a tenth of the range; a joint that moves further does not meet it
        if np.max(beyond, initial=-np.inf) > 0.1 * (high - low):
            return np.zeros(len(position), dtype=bool)
        return np.asarray(beyond >= 0.0)

    @property
    def named_poses(self) -> dict[str, list[float]]:
        """Positions of the fixed joints by name."""
        return {self.model.joint(j).name: pose.tolist() for j, pose in self.poses.items()}

    def spec(self) -> mujoco.MjSpec:
        """A new spec of the MJCF, which the caller may change."""
        return read_spec(self.mjcf)

    def torque(
        self,
        position: Array,
        velocity: Array,
        acceleration: Array,
        others: Mapping[str, tuple[Array, Array, Array]] | None = None,
    ) -> RigidBodyTorque:
        """Inverse dynamics along a motion of the joint, shape (n,) each, rad, rad/s, rad/s^2, with
        the same of other joints by name; joints not named stay where they are fixed, or at qpos0.
        """
        model, data = self.model, mujoco.MjData(self.model)
        tracks = [(self.joint_id, (position, velocity, acceleration))]
        tracks += [(_joint_id(model, name), track) for name, track in (others or {}).items()]
        qpos = [int(model.jnt_qposadr[j]) for j, _ in tracks]
        dofs = [int(model.jnt_dofadr[j]) for j, _ in tracks]
        q, v, a = (np.stack([track[i] for _, track in tracks], axis=1) for i in range(3))
        dof = dofs[0]
        body = int(model.jnt_bodyid[self.joint_id])
        e1, e2 = _across(model.jnt_axis[self.joint_id])
        n = len(position)
        load, turns, frames = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 9))
        anchors, moments, rows = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, len(dofs)))
        unit, column = np.eye(1, model.nv, dof)[0], np.zeros(model.nv)
        moved = _moved(model, body)
        weighs = model.body_mass[moved] * (1.0 - model.body_gravcomp[moved])
        # views, looked up once
        centres, frame = data.xipos[moved], data.xmat[body]
        axis, anchor = data.xaxis[self.joint_id], data.xanchor[self.joint_id]
        own_q, own_v, own_a, found = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
        for k in range(n):
            own_q[qpos], own_v[dofs], own_a[dofs] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            load[k] = found[dof]
            turns[k], frames[k], anchors[k] = axis, frame, anchor
            np.dot(weighs, centres, out=moments[k])
            mujoco.mj_mulM(model, data, column, unit)
            rows[k] = column[dofs]
        rubbing, unknown = self._of_tendons({j: track[:2] for j, track in tracks}, n)
        load += rubbing
        # a hinge and a slide have no unit in common
        alike = model.jnt_type[[j for j, _ in tracks]] == model.jnt_type[self.joint_id]
        inertia, coupling = rows[:, 0].copy(), np.linalg.norm(rows[:, alike], axis=1)
        if self.slide:
            none = np.zeros(n)
            return RigidBodyTorque(load, none, none, none, none, inertia, coupling, unknown)
        # torque the joint must supply: -(e x g).axis = -e.(g x axis), e turning with the body
        across = np.cross(model.opt.gravity, turns)
        R = frames.reshape(n, 3, 3)
        gx, gy = (-np.einsum("ni,nij,j->n", across, R, e) for e in (e1, e2))
        # of the moment m: -(m x g).axis, and as the moment turns -((axis x m) x g).axis
        moments -= weighs.sum() * anchors
        link = inertia - self.armature
        g = model.opt.gravity
        hold = -np.einsum("ni,ni->n", across, moments)
        along = np.einsum("ni,ni->n", turns, moments)
        stiffness = moments @ g - along * (turns @ g)
        per_inertia = np.divide(1.0, link, out=np.zeros(n), where=link > 0.0)
        sag, sway = hold * per_inertia, stiffness * per_inertia
        return RigidBodyTorque(load, gx, gy, sag, sway, inertia, coupling, unknown)

    def _of_tendons(
        self, moves: Mapping[int, tuple[Array, Array]], n: int
    ) -> tuple[Array, Array | None]:
        """Torque of the Coulomb friction of tendons between joints, and how much of it is unknown,
        from position and velocity, shape (n,), of joints that move, by index."""
        model, load, unknown = self.model, np.zeros(n), np.zeros(n)
        waves = wave_blocks(model)
        for t in range(model.ntendon):
            wave = waves.get(model.tendon(t).name)
            if wave is None and not model.tendon_frictionloss[t]:
                continue
            wraps = int(model.tendon_adr[t]) + np.arange(int(model.tendon_num[t]))
            if np.any(model.wrap_type[wraps] != mujoco.mjtWrap.mjWRAP_JOINT):
                continue
            turns = dict(zip(model.wrap_objid[wraps], model.wrap_prm[wraps], strict=True))
            own = turns.get(self.joint_id, 0.0)
            if own:
                turn, speed = (
                    sum(c * moves[j][k] for j, c in turns.items() if j in moves) for k in (0, 1)
                )
                levels = [own * model.tendon_frictionloss[t]]
                if wave is not None:
                    levels.append(own * wave_level(model, wave, turn))
                for level in levels:
                    load += level * direction(speed)
                    unknown += np.abs(level) * (1.0 - np.abs(direction(speed)))
        return load, unknown if unknown.any() else None


def direction(velocity: Array) -> Array:
    """Direction of a tendon's friction, which reverses within a part of its top speed, (n,)."""
    top = float(np.quantile(np.abs(velocity), 0.99)) or 1.0
    return np.asarray(np.tanh(velocity / (TURNS * top)))


def _moved(model: mujoco.MjModel, body: int) -> slice:
    """A body and all bodies attached to it, which are consecutive in MuJoCo."""
    end = body + 1
    while end < model.nbody and model.body_parentid[end] >= body:
        end += 1
    return slice(body, end)


def _joint_id(model: mujoco.MjModel, joint: str) -> int:
    j: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
    if j < 0:
        names = [joint_label(model, i) for i in range(model.njnt)]
        raise ModelError(
            f"no joint {joint!r} in the MJCF; available joints: {', '.join(names) or 'none'}"
        )
    if int(model.jnt_type[j]) not in ONE_DOF:
        kind = mujoco.mjtJoint(model.jnt_type[j]).name.removeprefix("mjJNT_").lower()
        raise ModelError(f"joint {joint!r} is a {kind} joint: friction acts on hinge and slide")
    return j


def _require_uncoupled(model: mujoco.MjModel, j: int) -> None:
    """Raise if an equality constraint shares the joint's torque with another joint."""
    for k in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_JOINT):
        pair = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
        if j in pair and model.eq_active0[k]:
            other = [joint_label(model, i) for i in pair if i not in (j, -1)]
            raise ModelError(
                f"joint {model.joint(j).name!r}: an equality constraint "
                f"{f'couples it to {other[0]!r}' if other else 'holds it'}, so its motion does not "
                "determine its torque: remove the constraint from the MJCF, and add the inertia "
                "that the joint drives through it to the joint's armature"
            )


def _across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors across a unit axis, the same ones for the same axis."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    e1 = np.cross(axis, helper)
    e1 /= np.linalg.norm(e1)
    return e1, np.cross(axis, e1)


def before_friction(
    model: str | Path, joints: Collection[str]
) -> tuple[str | Path, tuple[str, ...]]:
    """A model, the path or text of an MJCF or URDF, without friction of this package at some
    joints, to identify it again: itself if there is none, else the text of an MJCF; and the joints
    that had friction. ModelError: the model does not compile, or a block is damaged."""
    spec = read_spec(model)
    there = [name for name in carrying(spec) if name in joints]
    if not there:
        return model, ()
    take_out(spec, there)
    return model_text(spec, model), tuple(there)


def ignored_note(joints: Sequence[str]) -> str:
    """Sentence of the report on removed friction."""
    which = "joint" if len(joints) == 1 else "joints"
    return (
        f"The model contains friction at {which} {few(joints)} from an earlier run: it is ignored "
        "here and identified again."
    )
