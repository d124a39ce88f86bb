"""One joint of a robot with the corrected model, and with the user's model."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from frictionjoint.arrays import Array, Index, root_mean_square
from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.build_report import Runs
from frictionjoint.diagnose.close_loop import explain
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.report_parts import torque_rms
from frictionjoint.errors import FrictionJointError
from frictionjoint.identify.blocks import CORRELATION_TIMES, correlation_time
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.start import predict, settled
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import LoopErrors, Loops
from frictionjoint.replay.free_runs import replay, replay_rms
from frictionjoint.report.entries import Interval
from frictionjoint.robot.corrected_torque import Along
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.settle import Settled
from frictionjoint.robot.torsion import torsion

Model = str | Path


@dataclass(frozen=True)
class Task:
    """One joint, its logs and how they are analysed with the user's model, a path or text; the
    controller is for logs without a torque, refine and ends are those of `diagnose.close_loop`."""

    joint: str
    logs: list[JointLog]
    held_out: list[JointLog]
    user: Model
    fixed: Mapping[str, Pose] | None
    seed: int
    law: str | None
    controller: Controller | None = None
    refine: bool | None = None
    ends: bool = False


class Corrected:
    """Input of a process that analyses one joint: its task, and the shared causes.

    Attributes:
        model: the user's with all shared causes. original, corrections: of the user's model and
            of that one. without: those with all but one of the causes of this joint, by index.
        shape: of the law fitted with the user's model.
    """

    def __init__(self, task: Task, first: FittedJoint, shared: Settled, model: Model) -> None:
        found = shared.found
        self.task, self.model, self.shape = task, model, first.fit.shape
        self.original, self.corrections = found.original, found.state
        self.without = {
            i: found.without(i).state
            for i, choice in enumerate(shared.choices)
            if task.joint in choice.candidate.joints
        }


@dataclass(frozen=True)
class Fitted:
    """Fitted logs, held-out logs, and the fit."""

    prepared: Prepared
    kept_back: Prepared | None
    fit: Fit


class Explained:
    """Result of one joint.

    Attributes:
        before, after: fits with the user's model and with the corrected one.
        simulated: the fit in the robot's model: `after`, or the refined one.
        without: torque errors of the law without each shared cause; with_all: with all of them.
    """

    def __init__(self, joint: Corrected) -> None:
        task = joint.task
        body = RigidBody(joint.model, task.joint, task.fixed)
        options = task.seed, (lambda _: None), task.law, task.controller, task.refine, task.ends
        found = explain(task.logs, task.held_out, Bodies.one(body), *options)
        trace, report = found.trace, found.report
        after = Fitted(trace.prepared, found.kept_back, trace.final)
        self.without: dict[int, Rms] = {}
        before, runs = Fitted(trace.prepared, found.kept_back, trace.base), found.runs[0]
        self.with_all = report.before_torque
        if joint.without:
            # fitted logs, and held-out logs, as their load is under the corrections
            user, state = RigidBody(task.user, task.joint, task.fixed), joint.corrections
            kept = after.kept_back.segments if after.kept_back else ()
            logs = trace.prepared.segments, kept
            alongs = [tuple(Along(user, s, state) for s in segments) for segments in logs]
            shapes = joint.shape, trace.base.shape
            before = _law_alone(joint.original, after, alongs, shapes)
            runs, loops = _replays(before, task)
            self.without = {
                i: _torque(_law_alone(state, after, alongs, shapes), trace)
                for i, state in joint.without.items()
            }
            cov = stated_covariance(before.prepared, before.fit)
            report = replace(
                report,
                other_before=True,
                base=law_estimates(before.fit, cov, body.slide),
                laws=(law_parameters(before.fit), report.laws[1]),
                before_torque=_torque(before, trace),
                before_replay=replay_rms(*runs) if runs else Rms(None, None),
                closed_loops=(loops, report.closed_loops[1]) if report.closed_loops else None,
            )
        increase = {}
        if report.after_torque.worse_than(report.before_torque):
            increase["torque_rms"] = _torque_increase(before, after)
        if report.after_replay.worse_than(report.before_replay):
            increase["replay_rms"] = _replay_increase(runs, found.runs[1])
        self.report = replace(report, increase=increase, torsion=torsion(task.logs, trace.prepared))
        self.before, self.after, self.simulated = before, after, found.simulated


def explain_joint(joint: Corrected) -> Explained | str:
    """Analyse one joint with the corrected model, or say in one line why it has no result: a
    numerical failure on one joint's logs does not stop the other joints."""
    try:
        return Explained(joint)
    except FrictionJointError as error:
        return str(error)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        return f"{joint.task.joint}: the search broke down ({error}): name it alone with --joint"


def _law_alone(
    state: Corrections, after: Fitted, alongs: list[tuple[Along, ...]], shapes: Iterable[Shape]
) -> Fitted:
    """The law fitted under other corrections, on the same weighted samples, from several shapes."""
    segments, kept = (tuple(a.other(state) for a in x) for x in alongs)
    prepared = replace(after.prepared, segments=segments)
    fits = [refit(prepared, (), shape) for shape in shapes]
    prepared, best = settled(prepared, best_of(fits, lambda f: f.drive_rms))
    kept_back = after.kept_back and replace(after.kept_back, segments=kept)
    return Fitted(prepared, kept_back, best)


def _torque(fitted: Fitted, trace: Trace) -> Rms:
    """rms torque error in motion, with the drive of the final fit."""
    return torque_rms(fitted.prepared, fitted.kept_back, fitted.fit, trace.final.scale)


def _torque_increase(before: Fitted, after: Fitted) -> Interval:
    """Increase of the held-out error, on samples in motion with both models."""
    assert before.kept_back
    assert after.kept_back
    one, other = predict(before.kept_back, before.fit), predict(after.kept_back, after.fit)
    both = one.in_motion & other.in_motion
    log_index = np.repeat(np.arange(len(one.weight)), [len(w) for w in one.weight])
    scale = after.fit.scale / before.fit.scale
    return error_increase(one.error[both] * scale, other.error[both], log_index[both])


def _replays(fitted: Fitted, task: Task) -> tuple[Runs | None, LoopErrors | None]:
    """Free runs with the user's model, closed loops from a target; None without torque scale."""
    if fitted.fit.in_drive_units:
        return None, None
    body = RigidBody(task.user, task.joint, task.fixed)
    if task.controller:
        pairs = [(logs, [body] * len(logs)) for logs in (task.logs, task.held_out)]
        if loops := Loops.of(pairs, task.controller):
            errors = loops.errors([fitted.fit])[0]
            return errors.replays, errors
    held = replay(fitted.kept_back, body, fitted.fit) if fitted.kept_back else None
    return (replay(fitted.prepared, body, fitted.fit), held), None


def _replay_increase(before: Runs | None, after: Runs | None) -> Interval:
    """Increase of the error of held-out free runs, run by run."""
    assert before
    assert after
    one, other = before[1], after[1]
    assert one
    assert other
    if len(one.runs) > len(one.errors):
        both = float(np.sqrt(one.runs.mean()) + np.sqrt(other.runs.mean()))
        return _interval(other.runs - one.runs, np.ones(len(one.runs)), both)
    # whole logs, from their targets: the difference is gone again after a time
    first, then = (np.concatenate(runs.errors) for runs in (one, other))
    log = np.repeat(np.arange(len(one.errors)), [len(e) for e in one.errors])
    finite = np.isfinite(first) & np.isfinite(then)
    return error_increase(first[finite], then[finite], log[finite])


def error_increase(before: Array, after: Array, log_index: Index) -> Interval:
    """95% interval of the difference of two rms errors on the same samples of logs, shape (n,): far
    narrower than that of either error, for residuals on the same motion are correlated. Blocks of
    time span several correlation times of the difference of squared errors, if the log allows."""
    difference = after**2 - before**2
    parts: list[Array] = []
    for log in np.unique(log_index):
        own = difference[log_index == log]
        length = CORRELATION_TIMES * correlation_time(own)
        parts += np.array_split(own, max(1, round(len(own) / length)))
    sums, counts = np.array([x.sum() for x in parts]), np.array([len(x) for x in parts])
    return _interval(sums, counts, root_mean_square(before) + root_mean_square(after))


def _interval(sums: Array, counts: Array, both: float) -> Interval:
    """Interval of the difference of two rms values, from block sums of the difference of squares
    and the sum `both` of the two: a^2 - b^2 = (a - b) (a + b)."""
    blocks, n = len(sums), float(counts.sum())
    mean = float(sums.sum()) / n
    if blocks < 2 or not both:
        return -np.inf, np.inf
    spread = sums - mean * counts
    error = float(np.sqrt(blocks / (blocks - 1) * (spread @ spread))) / n
    # two-sided 95%
    half = float(stdtrit(blocks - 1, 0.975)) * error
    return (mean - half) / both, (mean + half) / both
