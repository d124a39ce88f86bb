"""Evaluate a model against logs: torque error, replay and closed loop per joint."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.control.controller import UNKNOWN, Controller
from frictionjoint.control.controller_file import GivenController, controller_of
from frictionjoint.control.mjcf_servos import controller_in
from frictionjoint.control.reconstruct import measures_drive, with_drive
from frictionjoint.errors import LogError, NoMotionError, ParameterError, few
from frictionjoint.evaluation.model import EvaluatedModel, friction_words, require_joint
from frictionjoint.evaluation.recording import Recording
from frictionjoint.evaluation.simulated import closed_loop, replay
from frictionjoint.evaluation.torque import torque_along
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.measured.log import JointLog, split_at_gaps
from frictionjoint.measured.readers import log_files, read_log, require_logs
from frictionjoint.measured.validate import require_motion
from frictionjoint.model_files import compile_model
from frictionjoint.model_joints import is_slide
from frictionjoint.mujoco_warnings import unheard
from frictionjoint.replay.windows import RUN_S

SCHEMA = "frictionjoint/evaluate-1"
ReadLog = Callable[[str | Path, str], JointLog]


@dataclass(frozen=True)
class JointCurves:
    """A log and the model's prediction at one joint, each of shape (n,).

    Attributes:
        log: name. time: s. velocity: rad/s or m/s, measured.
        drive: measured torque. needed: torque that the model requires for the motion. Both have
            passed the same filter.
        known: samples at which the two are compared. position: measured.
        replay_error: rad or m, NaN where nothing was simulated; None: no replay.
        closed_loop: simulated position; None: no closed loop.
    """

    log: str
    time: Array
    velocity: Array
    drive: Array
    needed: Array
    known: NDArray[np.bool_]
    position: Array
    replay_error: Array | None
    closed_loop: Array | None

    @property
    def torque_error(self) -> Array:
        """Required minus measured torque, at the samples that are compared."""
        return (self.needed - self.drive)[self.known]


@dataclass(frozen=True)
class JointEvaluation:
    """Error of a model at one joint.

    Attributes:
        friction: description of the model's friction. unit, position_unit: of torques and
            positions.
        drive_rms: rms of the measured torque. torque_rms: rms of the torque error.
        torque_percent: `torque_rms` in per cent of `drive_rms`; None if the drive is close to zero.
        replay_rms: rms position error of simulations that start from measured states every 0.5 s
            and receive the measured drive; None: no measured drive, or the simulations diverge.
        closed_loop_mae: mean absolute position error of whole logs simulated from their target;
            None: no target or no controller.
        curves: one per log.
    """

    friction: str
    unit: str
    position_unit: str
    drive_rms: float | None
    torque_rms: float | None
    torque_percent: float | None
    replay_rms: float | None
    closed_loop_mae: float | None
    curves: tuple[JointCurves, ...]

    def to_dict(self) -> dict[str, Any]:
        """The errors over all logs and per log, without the curves."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "curves"}
        logs = [
            {
                "log": c.log,
                "torque_rms": _rms(c.torque_error),
                "replay_rms": _replay_rms([c]),
                "closed_loop_mae": _closed_loop_mae([c]),
            }
            for c in self.curves
        ]
        return own | {"logs": logs}


@dataclass(frozen=True)
class Evaluation:
    """Error of a model on logs, see `evaluate`.

    Attributes:
        model: its name. joints: by name. notes: on the figures, one sentence each.
    """

    model: str
    joints: dict[str, JointEvaluation]
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """The content that ``evaluate --json`` prints."""
        joints = {name: x.to_dict() for name, x in self.joints.items()}
        return {"schema": SCHEMA, "model": self.model, "joints": joints, "notes": list(self.notes)}


def evaluate(
    model: str | Path,
    logs: Sequence[str | Path | JointLog],
    joints: Sequence[str] | None = None,
    controller: GivenController | None = None,
    fixed: Mapping[str, Pose] | None = None,
    read: ReadLog | None = None,
) -> Evaluation:
    """State the error of a model on logs, with any kind of friction; nothing is fitted.

    The model is evaluated as it is: with MuJoCo's own friction and damping, yield springs, the
    friction of a `dcmotor`, friction of this package, or none. Contacts are off; joints that no log
    contains stay at their initial position.

    Args:
        model: path or text of an MJCF or URDF. logs: paths, folders, or logs of one joint.
        joints: names; None: all joints with a drive in every log, or the model's only joint.
        controller: controller that moved the joints to their targets, see `close_loop`; None: the
            position servo of the model, if the model has one and the log has a target.
        fixed: positions of joints that no log contains, rad or m.
        read: function that reads a path; None: `read_log`.
    Raises:
        FrictionJointError: bad logs or model, in one line. TypeError: one log instead of a list.
    """
    require_logs(logs, 0.0)
    paths = [x for log in logs for x in ([log] if isinstance(log, JointLog) else log_files(log))]
    compiled = compile_model(model)
    names = list(joints) if joints else _joints(paths, compiled)
    if not names:
        raise LogError(
            "no joint is in the model and in every log: give joints, names in the model, and logs "
            "of these"
        )
    for name in names:
        require_joint(compiled, name)
    controllers = {name: _controller(controller, name, compiled) for name in names}
    collected: dict[str, list[JointCurves]] = {name: [] for name in names}
    notes: dict[str, None] = {}
    with unheard():
        for path in paths:
            for parts in _parts(path, names, read or read_log, notes):
                for name, found in _one_log(model, parts, controllers, fixed, notes).items():
                    collected[name].append(found)
    evaluated = {
        n: _of_joint(compiled, n, curves, notes) for n, curves in collected.items() if curves
    }
    if not evaluated:
        raise LogError(f"{few(names)}: no log in which it moves, record a motion")
    title = Path(model).name if not str(model).lstrip().startswith("<") else "the MJCF"
    return Evaluation(title, evaluated, tuple(notes))


def _joints(paths: Sequence[str | Path | JointLog], model: Any) -> list[str]:
    """Joints to evaluate if the user names none."""
    from frictionjoint.identify.matching import joints_to_explain

    if files := [x for x in paths if not isinstance(x, JointLog)]:
        return joints_to_explain(files, model)
    recorded = {x.joint for x in paths if isinstance(x, JointLog)}
    names = (model.joint(j).name for j in range(model.njnt))
    return [name for name in names if recorded == {name}]


def _controller(given: GivenController | None, joint: str, model: Any) -> Controller | None:
    if given is None:
        try:
            return controller_in([model], joint)
        except ParameterError:
            return None
    found = controller_of(given, joint, [model])
    if found is not None and UNKNOWN in (found.kp, found.supply_v):
        raise ParameterError(
            f"controller of joint {joint!r}: kp or supply_v is unknown: nothing is fitted here, "
            "give numbers"
        )
    return found


def _parts(
    path: str | Path | JointLog, names: Sequence[str], read: ReadLog, notes: dict[str, None]
) -> list[dict[str, JointLog]]:
    """Parts of a log between its gaps, with the joints that move."""
    by_joint: dict[str, list[JointLog]] = {}
    for name in names:
        try:
            log = path if isinstance(path, JointLog) else read(path, name)
            require_motion(f"{log.name}, {name}", log.position)
        except NoMotionError as error:
            if len(names) == 1:
                raise
            notes[f"{error}; left out."] = None
            continue
        notes |= dict.fromkeys(log.notes)
        by_joint[name] = split_at_gaps(log)
    count = min((len(parts) for parts in by_joint.values()), default=0)
    return [{name: parts[i] for name, parts in by_joint.items()} for i in range(count)]


def _one_log(
    model: str | Path,
    logs: dict[str, JointLog],
    controllers: Mapping[str, Controller | None],
    fixed: Mapping[str, Pose] | None,
    notes: dict[str, None],
) -> dict[str, JointCurves]:
    """The curves of one log, by joint."""
    measured = {name: measures_drive(log) for name, log in logs.items()}
    recording = Recording.of({n: with_drive(log, controllers[n]) for n, log in logs.items()})
    m = EvaluatedModel(model, recording, fixed)
    between_restarts = max(2, round(RUN_S / recording.step))
    along = torque_along(m, recording, between_restarts)
    runs = replay(m, recording, along) if all(measured.values()) else None
    known = {n: c for n in logs if (c := controllers[n]) and logs[n].target is not None}
    loop = closed_loop(m, recording, known) if set(known) == set(logs) else None
    if known and loop is None:
        notes["Closed loop: not every joint has a target and a controller."] = None
    found = {}
    for name, log in recording.logs.items():
        motion, drive = recording.motion[name], recording.filtered[name]
        if m.controls[name] is not None:
            drive = recording.filter(along.given[name])
        low, high = m.limits(name)
        found[name] = JointCurves(
            log=log.name,
            time=recording.time,
            velocity=motion[1],
            drive=drive,
            needed=recording.filter(along.needed[name]),
            known=recording.known[name] & (motion[0] > low) & (motion[0] < high),
            position=motion[0],
            replay_error=runs[name] if runs else None,
            closed_loop=loop[name] if loop else None,
        )
    return found


def _of_joint(
    model: Any, joint: str, curves: list[JointCurves], notes: dict[str, None]
) -> JointEvaluation:
    unit, position_unit = ("N", "m") if is_slide(model, joint) else ("N m", "rad")
    torque = _rms(np.concatenate([c.torque_error for c in curves]))
    size = _rms(np.concatenate([c.drive[c.known] for c in curves]))
    percent = None
    if torque is None or size is None:
        notes[f"{joint}: no part of the logs has a known drive: no torque error is stated."] = None
    elif torque <= 10.0 * size:  # a larger percentage only means that the drive is off
        percent = 100.0 * torque / size
        if percent > 100.0:
            notes[
                f"{joint}: the model errs by more than the whole drive: check signs, units and the "
                "columns of the logs, and the masses of the model."
            ] = None
    else:
        notes[
            f"{joint}: the drive in the logs is next to nothing, {size:.3g} {unit} rms, and "
            f"the model needs {torque:.3g} {unit} more: was it off, or is a column, of the drive "
            "or of the position, in another unit? No percentage is stated."
        ] = None
    replayed = _replay_rms(curves)
    if replayed is not None and replayed > max(float(np.ptp(c.position)) for c in curves):
        notes[f"{joint}: no position error, as the simulation leaves the measured motion."] = None
        replayed = None
    return JointEvaluation(
        friction=friction_words(model, joint),
        unit=unit,
        position_unit=position_unit,
        drive_rms=size,
        torque_rms=torque,
        torque_percent=percent,
        replay_rms=replayed,
        closed_loop_mae=_closed_loop_mae(curves),
        curves=tuple(curves),
    )


def _rms(x: Array) -> float | None:
    return root_mean_square(x) if len(x) else None


def _replay_rms(curves: Sequence[JointCurves]) -> float | None:
    errors = [c.replay_error for c in curves if c.replay_error is not None]
    return _rms(x[~np.isnan(x)]) if errors and len(x := np.concatenate(errors)) else None


def _closed_loop_mae(curves: Sequence[JointCurves]) -> float | None:
    """Mean absolute error in closed loop; None also if a simulation became unstable."""
    errors = [c.closed_loop - c.position for c in curves if c.closed_loop is not None]
    mean = float(np.mean(np.abs(np.concatenate(errors)))) if errors else np.inf
    return mean if np.isfinite(mean) else None
