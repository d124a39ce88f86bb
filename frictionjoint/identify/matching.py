"""The MJCF of each log, and whether logs and model have the same joints in known positions.

A joint that no log measures is held in the torque balance. If its position changes the torque of
the examined joint, it must be given: a guess would appear as friction.
"""

import difflib
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.errors import NO_JOINT, LogError, ModelError, few
from frictionjoint.identify.fixed_joints import BALL, FREE, SLIDE, Pose, joint_label
from frictionjoint.identify.rigid_body import RigidBody, ignored_note
from frictionjoint.measured.derivatives import differentiate, speed_note
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import joints_with_drive
from frictionjoint.measured.validate import check_time
from frictionjoint.model_files import ONE_DOF


def check_logs(
    logs: Sequence[JointLog], body: RigidBody, held_out: Sequence[JointLog] = ()
) -> tuple[str, ...]:
    """Check that logs can be of a joint of a model, by names, kinds, ranges and known positions.

    Returns:
        notes on repairs of the logs and on assumptions.
    Raises:
        LogError: a log of another kind of joint, the same samples twice, a joint that the model
            does not have, one with an unknown position that matters, or travel far beyond the
            model's range.
    """
    everything = [*logs, *held_out]
    for log in everything:
        check_time(log.name, log.time, lambda sample: sample)
        if log.slide != body.slide:
            kind, columns = ("slide", "m, force_n") if body.slide else ("hinge", "rad, torque_nm")
            raise LogError(
                f"{log.name}: joint {body.joint!r} is a {kind} in the MJCF: its columns must be "
                f"position_{columns}"
            )
    _check_repeats(logs, held_out)
    said: list[str] = []
    for log in everything:
        said += [*log.notes, *speed_note(log)]
        if log.joint not in (body.joint, "joint"):  # a reader's name where a file has none
            said.append(f"{log.name}: a log of joint {log.joint!r}, used for {body.joint!r}.")
        _check_range(log, body)
        _check_limit(log, body)
        said += _check_joints(log, body)
    return (*dict.fromkeys(said), *_limit_note([log.position for log in everything], body))


def _check_repeats(logs: Sequence[JointLog], held_out: Sequence[JointLog]) -> None:
    """The same samples must not be used twice, whatever the files are called."""
    everything = [*logs, *held_out]
    for i, log in enumerate(everything):
        for other in everything[:i]:
            if np.array_equal(log.time, other.time) and np.array_equal(
                log.position, other.position
            ):
                fix = "hold out another log" if i >= len(logs) else "give it once"
                raise LogError(f"{log.name}: the same samples as {other.name}: {fix}")


def _check_range(log: JointLog, body: RigidBody) -> None:
    model, j = body.model, body.joint_id
    if not model.jnt_limited[j]:
        return
    low, high = (float(x) for x in model.jnt_range[j])
    travel = float(np.ptp(log.position))
    # Twice the model's range is another unit or joint.
    if travel > 2.0 * (high - low):
        unit = "m" if body.slide else "rad"
        raise LogError(
            f"{log.name}: the position travels {travel:.3g} {unit} where the model's joint "
            f"{body.joint!r} has {high - low:.3g} {unit}: check the unit (degrees?), the side of "
            "the gear, and the joint"
        )


def _limit_note(positions: Sequence[Array], body: RigidBody) -> tuple[str, ...]:
    """Fraction of the logs at a limit of the joint, or beyond it."""
    beyond = np.array([np.max(body.beyond_limits(q)) for q in positions])
    if np.all(beyond < 0.0):
        return ()
    low, high = body.limits
    at = [body.at_limit(q) for q in positions]
    unit = "m" if body.slide else "rad"
    said = [f"The joint reaches the end of its range in the MJCF, {low:.4g} to {high:.4g} {unit}."]
    stands = np.array([x.any() for x in at])
    if np.any(stands):
        said.append(
            f"In {np.concatenate(at).mean():.1%} of the samples it is there. The torque of a limit "
            "is unknown, so these samples and those close by are ignored."
        )
    if np.any((beyond >= 0.0) & ~stands):
        said.append(
            f"It moves up to {beyond.max():.3g} {unit} beyond, so the range is assumed wrong there."
        )
    return (" ".join(said),)


def _check_limit(log: JointLog, body: RigidBody) -> None:
    """Reject a torque that no actuator of the model could deliver: its unit is probably wrong."""
    model, j = body.model, body.joint_id
    if log.torque is None or not model.jnt_actfrclimited[j]:
        return
    limit = float(np.abs(model.jnt_actfrcrange[j]).max())
    peak = float(np.quantile(np.abs(log.torque), 0.99))
    # Ten times the actuators' limit is another unit.
    if limit > 0.0 and peak > 10.0 * limit:
        unit, small = ("N", "mN") if body.slide else ("N m", "N mm, mN m")
        raise LogError(
            f"{log.name}: the torque reaches {peak:.3g} {unit} where the model's actuators are "
            f"limited to {limit:.3g} {unit}: check its unit ({small}?) and actuatorfrcrange"
        )


def _check_joints(log: JointLog, body: RigidBody) -> list[str]:
    """Check that the model has every joint of the logs, and that relevant positions are known."""
    model = body.model
    fixed = {model.joint(j).name for j in body.poses}
    both = sorted(fixed & set(log.other_positions))
    if both:
        raise ModelError(f"--fixed {both[0]}: {log.name} contains its motion, leave one out")
    unknown = sorted(set(log.other_positions) - body.joint_names)
    absent = sorted(body.joint_names - set(log.other_positions) - fixed)
    if unknown and absent:
        near = difflib.get_close_matches(unknown[0], absent, 1)
        hint = f": {near[0]!r}?" if near else ""
        raise LogError(
            f"{log.name}: no joint {unknown[0]!r} in the MJCF{hint} "
            f"(the log lacks its {', '.join(absent)})"
        )
    said = [f"{log.name}: joint {name!r} is not in the MJCF and is ignored" for name in unknown]
    matter = _that_matter(log, body)
    hinges = [joint_label(model, j) for j in matter if int(model.jnt_type[j]) in ONE_DOF]
    if hinges:
        example = " ".join(f"--fixed {name}=VALUE" for name in hinges[:3])
        raise LogError(
            f"{log.name}: no position of {', '.join(hinges)}, which the torque at "
            f"{body.joint!r} depends on: log it, or give the pose that was held, {example} (rad, m)"
        )
    for j in matter:
        kind = "floating base" if int(model.jnt_type[j]) == FREE else "ball joint"
        label = joint_label(model, j)
        said.append(
            f"The {kind} ({label}) is assumed to be at its position in the MJCF; "
            "--fixed sets another."
        )
    return said


def _that_matter(log: JointLog, body: RigidBody) -> list[int]:
    """Indices of joints with unknown positions on which the torque along a log depends."""
    model = body.model
    logged = sorted(set(log.other_positions) & body.joint_names)
    known = {*body.poses, body.joint_id, *(model.joint(name).id for name in logged)}
    open_ones = [j for j in range(model.njnt) if j not in known]
    if not open_ones:
        return []
    motion = differentiate(log)
    k = np.linspace(0, len(motion.time) - 1, 12).astype(int)
    qpos, qvel, qacc = (np.tile(x, (len(k), 1)) for x in (model.qpos0, *np.zeros((2, model.nv))))
    for name in logged:
        address = int(model.jnt_qposadr[model.joint(name).id])
        qpos[:, address] = np.interp(motion.time[k], log.time, log.other_positions[name])
    qpos[:, int(model.jnt_qposadr[body.joint_id])] = motion.position[k]
    dof = int(model.jnt_dofadr[body.joint_id])
    qvel[:, dof], qacc[:, dof] = motion.velocity[k], motion.acceleration[k]
    rng = np.random.default_rng(0)
    hinges = [j for j in open_ones if int(model.jnt_type[j]) in ONE_DOF]
    change, size = dict.fromkeys(open_ones, 0.0), 0.0
    # three poses of each joint, next to four arrangements of the others
    for _ in range(4):
        for j in hinges:
            _move(model, j, qpos, rng)
        load = _load(body, qpos, qvel, qacc)
        size = max(size, root_mean_square(load))
        for j in open_ones:
            for _ in range(3):
                moved = qpos.copy()
                _move(model, j, moved, rng)
                change[j] = max(change[j], root_mean_square(_load(body, moved, qvel, qacc) - load))
    # A pose matters if it changes the load by 1%.
    return [j for j in open_ones if change[j] > 0.01 * size]


def _move(model: mujoco.MjModel, j: int, qpos: Array, rng: np.random.Generator) -> None:
    """Put a joint at another pose, within its range."""
    address, kind = int(model.jnt_qposadr[j]), int(model.jnt_type[j])
    if kind in (FREE, BALL):
        address += 3 if kind == FREE else 0
        turn = rng.standard_normal(4)
        qpos[:, address : address + 4] = turn / np.linalg.norm(turn)
        return
    # m, or rad, where the model has no limits
    reach = 0.3 if kind == SLIDE else np.pi
    middle = float(model.qpos0[address])
    low, high = (middle - reach, middle + reach)
    if model.jnt_limited[j]:
        low, high = model.jnt_range[j]
    qpos[:, address] = rng.uniform(low, high)


def _load(body: RigidBody, qpos: Array, qvel: Array, qacc: Array) -> Array:
    """Rigid-body torque at the joint in some states, shape (n,)."""
    data = mujoco.MjData(body.model)
    dof = int(body.model.jnt_dofadr[body.joint_id])
    load = np.zeros(len(qpos))
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:], data.qacc[:] = qpos[k], qvel[k], qacc[k]
        mujoco.mj_inverse(body.model, data)
        load[k] = data.qfrc_inverse[dof]
    return load


def joints_to_explain(
    logs: Sequence[str | Path], model: mujoco.MjModel, columns: dict[str, str] | None = None
) -> list[str]:
    """Hinges and slides of a model with a drive in all logs, base first.

    Columns that name no joint are those of the only joint of a model.

    Raises:
        ModelError: the model has none.
        LogError: a log has none of those in the model and in the logs before it.
    """
    has = [joint_label(model, j) for j in range(model.njnt) if int(model.jnt_type[j]) in ONE_DOF]
    if not has:
        raise ModelError(NO_JOINT)
    names = has
    for path in logs:
        driven = joints_with_drive(path, columns) or (has if len(has) == 1 else [])
        common = [name for name in names if name in driven]
        if not common:
            source = "model" if names is has else "model and of the logs before it"
            raise LogError(
                f"{Path(path).name}: no joint of the {source} has a position and a drive here: "
                f"wanted is one of {few(names, 12)}, the columns name "
                f"{few(driven, 12) or 'none'}; name one joint with --joint, or its columns "
                "--column JOINT.position_rad=NAME"
            )
        names = common
    return names


class Bodies:
    """Rigid bodies of one joint under one or several loads.

    Args:
        model: an MJCF, or one per pattern of log names (``light*``); the first pattern that matches
            is used.
        joint: name. fixed: see `RigidBody`.
    Raises:
        ModelError: see `RigidBody`; there is no pattern.
    """

    def __init__(
        self,
        model: str | Path | Mapping[str, str | Path],
        joint: str,
        fixed: Mapping[str, Pose] | None = None,
    ) -> None:
        by_pattern = dict(model) if isinstance(model, Mapping) else {"*": model}
        if not by_pattern:
            raise ModelError("model is empty: give an MJCF, or one by a pattern of the logs' names")
        self._bodies = {p: RigidBody(mjcf, joint, fixed) for p, mjcf in by_pattern.items()}

    @classmethod
    def one(cls, body: RigidBody) -> "Bodies":
        """The same body for all logs."""
        found = cls.__new__(cls)
        found._bodies = {"*": body}
        return found

    @property
    def models(self) -> list[mujoco.MjModel]:
        """Compiled models, one per load."""
        return [body.model for body in self._bodies.values()]

    def of(self, logs: Sequence[JointLog]) -> list[RigidBody]:
        """The body of each log; ModelError: no pattern matches a log."""
        return [self._of(log) for log in logs]

    def _of(self, log: JointLog) -> RigidBody:
        for pattern, body in self._bodies.items():
            if fnmatchcase(log.name, pattern):
                return body
        listed = ", ".join(self._bodies)
        raise ModelError(f"no model for log {log.name!r}: its name fits none of {listed}")

    def check(self, logs: Sequence[JointLog], held_out: Sequence[JointLog]) -> tuple[str, ...]:
        """`check_logs` of each body with its logs, with notes on omitted parts of the MJCF."""
        said: list[str] = []
        for body in self._bodies.values():
            mine, theirs = ([x for x in some if self._of(x) is body] for some in (logs, held_out))
            said += check_logs(mine, body, theirs)
            if body.carried:
                said.append(ignored_note([body.joint]))
            if body.native:
                said.append(
                    f"Joint {body.joint!r} has {body.native} in the MJCF. It is ignored here, and "
                    "removed where the identified friction is added, because it would count twice."
                )
        return tuple(dict.fromkeys(said))
