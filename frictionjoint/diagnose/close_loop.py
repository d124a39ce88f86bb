"""Identify the friction of one joint and search for missing effects: from logs to a report."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.diagnose import report_parts as parts
from frictionjoint.diagnose.build_report import Runs, build_report
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.joint_logs import JointLogs, prepare_logs
from frictionjoint.diagnose.resulting_model import ResultingModel, resulting_model
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.early_checks import load_shows, scale_is_determined
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.weights import errors_elsewhere, weighted
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.in_report import with_recordings
from frictionjoint.refine.objective import window_squares
from frictionjoint.replay.free_runs import replay, replayed_whole, simulated_whole
from frictionjoint.report.entries import SimulatedPosition
from frictionjoint.report.joint_report import Report
from frictionjoint.threads import one_thread


@dataclass(frozen=True)
class Analysis:
    """Outcome of one joint."""

    report: Report
    trace: Trace
    simulated: Fit  # what the model contains
    kept_back: Prepared | None  # held-out logs, weighted by the final fit
    runs: tuple[Runs | None, Runs | None]  # of the first and the final fit; None without a scale


@one_thread
def explain(
    logs: Sequence[JointLog],
    held_out: Sequence[JointLog],
    bodies: Bodies,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    law: str | None = None,
    controller: Controller | None = None,
    refine: bool | None = None,
    ends: bool = False,
) -> Analysis:
    """Report and findings for the logs of one joint.

    Args:
        held_out: may be empty. bodies: the model around the joint.
        controller: what drove the joint to its target.
        ends: whether the held-out logs are the ends of the others, no recordings of their own.
            Others: see `commands.close_loop`.
    Raises:
        FrictionJointError: bad logs, in one line.
    """
    begin = time.perf_counter()
    progress("computing the torque of the model")
    prepared = prepare_logs(logs, held_out, bodies, controller)
    model = resulting_model(prepared, _search(prepared, seed, progress, law), refine, progress)
    found = model.trace
    cov = stated_covariance(found.prepared, found.final) + found.other_laws.covariance(found.final)
    left = errors_elsewhere(found.prepared, found.final, cov)
    kept_back = weighted(model.kept_back, found.final, left) if model.kept_back else None
    progress("simulating the logs")
    runs, positions = _simulate(prepared, model)
    progress("choosing what to record next")
    report = build_report(prepared, model, cov, kept_back, runs, positions, begin)
    progress("comparing the recordings")
    report = _compare_recordings(report, prepared, ends)
    simulated = model.fit if model.scaled else found.final
    both = (runs[0], runs[1]) if runs else (None, None)
    return Analysis(report, found, simulated, kept_back, both)


def _search(logs: JointLogs, seed: int, progress: Callable[[str], None], law: str | None) -> Trace:
    def replayed(prepared: Prepared, fitted: Fit) -> Array | None:
        if logs.loops is None:
            known = scale_is_determined(prepared, fitted)
            return replayed_whole(prepared, logs.bodies, fitted) if known else None
        if not load_shows(fitted):
            return None
        whole = simulated_whole(fitted, logs.body.armature, in_closed_loop=True)
        return window_squares(logs.loops.fit, fitted) if whole else None

    return trace(logs.prepared, seed, progress, law, replayed, by_motion=logs.loops is not None)


def _simulate(
    logs: JointLogs, model: ResultingModel
) -> tuple[list[Runs], tuple[SimulatedPosition, ...]]:
    """Free runs of the first and of the resulting model; empty without a torque scale.

    With a controller, the target drives the joint, as it will where the model is used.
    """
    found = model.trace
    if model.closed:
        after = (model.taken.loops if model.taken else None) or model.closed[1]
        runs = [loop.replays for loop in (model.closed[0], after)]
        return runs, parts.followed_positions(model.closed[0], after)
    if not model.scaled:
        return [], ()
    first = logs.prepared, logs.kept_back, found.base
    last = found.prepared, model.kept_back, model.fit
    runs = [
        (replay(on, logs.bodies, f), replay(kept, logs.held_out_bodies, f) if kept else None)
        for on, kept, f in (first, last)
    ]
    return runs, parts.simulated_positions(found.prepared, model.kept_back, runs)


def _compare_recordings(report: Report, logs: JointLogs, ends: bool) -> Report:
    """The report with the recordings compared with each other; `ends` as in `explain`."""
    loads = logs.bodies if ends else [*logs.bodies, *logs.held_out_bodies]
    recordings = zip((*logs.fitted, *logs.held_out), loads, strict=False)
    # the model of the report has the load of the first log
    alike = [log for log, load in recordings if load is logs.body]
    if len(alike) < len(loads):
        name = logs.fitted[0].name
        note = f"Recordings are compared with each other only under the load of {name}."
        report = replace(report, notes=(*report.notes, note))
    return with_recordings(report, alike, logs.body.named_poses)
