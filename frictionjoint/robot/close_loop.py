"""From the logs and the model of one joint or of a whole robot to one report and one model."""

import itertools
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller_file import GivenController, controller_of
from frictionjoint.diagnose.close_loop import explain
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rigid_body import before_friction, ignored_note
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.measured.arguments import require_seed
from frictionjoint.model_files import compile_model, read_spec
from frictionjoint.model_text import model_text
from frictionjoint.replay.free_runs import friction_spec, replay_joints
from frictionjoint.report.joint_report import Report
from frictionjoint.report.robot_report import (
    RobotErrors,
    RobotReport,
    SharedCause,
    UnitsReport,
    mean_percent,
    notes_of,
)
from frictionjoint.robot.alternatives import disagreements
from frictionjoint.robot.causes.cause import Found
from frictionjoint.robot.corrections import write_corrections
from frictionjoint.robot.exchanged_joints import require_own_columns
from frictionjoint.robot.excitation import next_trajectory
from frictionjoint.robot.explain import Corrected, Explained, Fitted, Model, Task, explain_joint
from frictionjoint.robot.information import information, undetermined
from frictionjoint.robot.joint import FittedJoint, first_fit
from frictionjoint.robot.logs import Place, RobotLogs, by_place
from frictionjoint.robot.settle import Settled
from frictionjoint.robot.shared import shared_causes
from frictionjoint.robot.workers import processes, workers
from frictionjoint.threads import one_thread


@dataclass(frozen=True)
class Options:
    """How logs are analysed, see `commands.close_loop`; a Dask scheduler at an address analyses the
    joints of a robot with its workers, in place of `jobs` processes."""

    seed: int = 0
    progress: Callable[[str], None] = lambda text: None
    law: str | None = None
    fixed: Mapping[str, Pose] | None = None
    controller: GivenController | None = None
    refine: bool | None = None
    jobs: int | None = None
    scheduler: str | None = None

    def __post_init__(self) -> None:
        require_seed(self.seed)
        forms_of(self.law or INTEGRATED_LAW)


def close_loop_logs(
    logs: RobotLogs, model: str | Path | Mapping[str, str | Path], how: Options
) -> Report | RobotReport:
    """Report of one joint that was named alone, or of a robot; FrictionJointError for bad input."""
    if not logs.alone:
        return close_loop_robot(logs, model, how)
    # one joint has no causes to share; its logs may have different loads
    (joint,) = logs.joints
    bodies = Bodies(model, joint, how.fixed)
    known = controller_of(how.controller, joint, bodies.models)
    options = how.seed, how.progress, how.law, known, how.refine, logs.ends
    return explain(logs.fit[joint], logs.held_out[joint], bodies, *options).report


@one_thread
def close_loop_robot(
    logs: RobotLogs, model: str | Path | Mapping[str, str | Path], how: Options
) -> RobotReport:
    """Fit joints, find shared causes and what each joint lacks; errors: see `close_loop_logs`."""
    assert not isinstance(model, Mapping)
    begin = time.perf_counter()
    model, carried = before_friction(model, logs.joints)
    compiled = compile_model(model)
    tasks = {
        n: Task(
            *(n, logs.fit[n], logs.held_out[n], model, how.fixed, how.seed, how.law),
            *(controller_of(how.controller, n, [compiled]), how.refine, logs.ends),
        )
        for n in logs.joints
    }
    count = processes(len(tasks)) if how.jobs is None else how.jobs
    with workers(count, how.scheduler) as each:
        how.progress(f"fitting the friction law of {len(tasks)} joints")
        firsts = dict(zip(tasks, each(_first, tasks.values()), strict=True))
        failed = logs.failed | {n: x for n, x in firsts.items() if isinstance(x, str)}
        fitted = {n: x for n, x in firsts.items() if not isinstance(x, str)}
        if not fitted:
            raise LogError(next(iter(failed.values())))
        require_own_columns(tasks, fitted)
        shared = shared_causes(list(fitted.values()), logs.moving, each, how.seed, how.progress)
        corrected = model
        if shared.found.causes:
            spec = read_spec(model)
            write_corrections(spec, shared.found.state)
            corrected = model_text(spec, model)
        ready = [Corrected(tasks[n], x, shared, corrected) for n, x in fitted.items()]
        outcomes, explained = {}, iter(each(explain_joint, ready))
        for i, name in enumerate(fitted):
            how.progress(f"joint {i + 1} of {len(fitted)}: {name}")
            outcomes[name] = next(explained)
    done = {n: x for n, x in outcomes.items() if not isinstance(x, str)}
    failed |= {n: x for n, x in outcomes.items() if isinstance(x, str)}
    if not done:
        raise LogError(next(iter(failed.values())))
    how.progress("choosing what to record next")
    known = information(shared.joints, logs.moving)
    excitation = next_trajectory(shared.joints, logs.moving, known, how.seed)
    how.progress("simulating all joints together")
    poses = next(iter(fitted.values())).alongs[0].body.named_poses
    spec = read_spec(corrected)
    for joint, one in done.items():
        if not one.simulated.in_drive_units:
            friction_spec(spec, joint, one.simulated)
    spec.compile()
    reports = {n: x.report for n, x in done.items()}
    simulated = {n: replace(x.after, fit=x.simulated) for n, x in done.items()}
    return RobotReport(
        logs=logs.entries,
        joints=reports,
        failed=failed,
        shared=_stated(shared, done),
        before=RobotErrors(
            mean_percent([(r.before_torque, r.drive_rms("before")) for r in reports.values()]),
            _replay(model, {n: x.before for n, x in done.items()}, poses),
        ),
        after=RobotErrors(
            mean_percent([(r.after_torque, r.drive_rms("after")) for r in reports.values()]),
            _replay(corrected, simulated, poses),
        ),
        undetermined=undetermined(known, {n: r.final for n, r in reports.items()}),
        excitation=excitation,
        mjcf=model_text(spec, corrected),
        seconds=time.perf_counter() - begin,
        notes=(
            *([ignored_note(carried)] if carried else ()),
            *logs.notes,
            *disagreements(shared),
            *notes_of(reports),
        ),
    )


def _first(task: Task) -> FittedJoint | str:
    try:
        return first_fit(task.logs, task.user, task.joint, task.fixed, task.controller)
    except FrictionJointError as error:
        return str(error)


def _replay(model: Model, joints: Mapping[str, Fitted], poses: Mapping[str, list[float]]) -> Rms:
    """Replay of all joints together, on fitted and held-out logs; none without a torque."""
    if any(x.fit.in_drive_units or x.prepared.commanded for x in joints.values()):
        return Rms(None, None)

    def rms(own: Mapping[str, Prepared | None]) -> float | None:
        logs: dict[Place, dict[str, Segment]] = {}
        for name, prepared in own.items():
            for place, segment in by_place(prepared.segments if prepared else ()).items():
                logs.setdefault(place, {})[name] = segment
        fits = {n: joints[n].fit for n, prepared in own.items() if prepared}
        if not logs:
            return None
        return replay_joints(read_spec(model), list(logs.values()), fits, poses).stated

    kept_back = {n: x.kept_back for n, x in joints.items()}
    return Rms(rms({n: x.prepared for n, x in joints.items()}), rms(kept_back))


def _stated(shared: Settled, done: Mapping[str, Explained]) -> tuple[SharedCause, ...]:
    causes = []
    for i, choice in enumerate(shared.choices):
        cause, numbers = shared.found.causes[i], _estimates(shared.found, i, shared.covariance[i])
        own = {n: (x.without[i], x.with_all) for n, x in done.items() if i in x.without}
        causes.append(SharedCause(cause.name, cause.place, numbers, choice.evidence, own))
    for common, choice in shared.common:
        # a joint whose own search has dropped the effect shares it no longer
        own = {n: pair for n, x in done.items() if (pair := _own(x, common.term.name))}
        if len(own) > 1:
            place, evidence = {"common_to": ", ".join(own)}, choice.evidence
            causes.append(SharedCause(common.term.name, place, common.parameters, evidence, own))
    return tuple(causes)


def _own(joint: Explained, effect: str) -> tuple[Rms, Rms] | None:
    """Torque errors of a joint without and with an effect of its own; None if it has none."""
    added = joint.report.added
    pairs = itertools.pairwise((joint.with_all, *(x.torque_rms for x in added)))
    return next((pair for x, pair in zip(added, pairs, strict=True) if x.effect == effect), None)


def _estimates(found: Found, i: int, cov: Array) -> dict[str, Estimate]:
    """A cause's values with their standard errors, to first order."""
    cause, x = found.causes[i], found.numbers[i]
    state = found.without(i).state
    values = cause.values(state, x)

    def at(x: Array) -> Array:
        return np.array([value for value, _ in cause.values(state, x).values()])

    slopes = [
        (at(x + way) - at(x - way)) / (2.0 * step)
        for step, way in zip(cause.steps, np.diag(cause.steps), strict=True)
    ]
    return {
        name: Estimate(value, _error(slope, cov), unit)
        for (name, (value, unit)), slope in zip(values.items(), np.transpose(slopes), strict=True)
    }


def _error(slope: Array, cov: Array) -> float | None:
    """Standard error of a value with these derivatives; None if it is undetermined."""
    at = np.flatnonzero(slope)
    variance = float(slope[at] @ cov[np.ix_(at, at)] @ slope[at])
    return float(np.sqrt(max(0.0, variance))) if np.isfinite(variance) else None


def close_loop_units(
    units: Mapping[str, RobotLogs], model: str | Path | Mapping[str, str | Path], how: Options
) -> UnitsReport:
    """`close_loop_robot` for each unit; those without a result are left out, LogError if all."""
    found: dict[str, RobotReport] = {}
    failed: dict[str, str] = {}
    for name, logs in units.items():

        def say(text: str, unit: str = name) -> None:
            how.progress(f"{unit}: {text}")

        try:
            found[name] = close_loop_robot(logs, model, replace(how, progress=say))
        except FrictionJointError as error:
            failed[name] = str(error)
    if not found:
        raise LogError(next(iter(failed.values())))
    return UnitsReport(found, failed)
