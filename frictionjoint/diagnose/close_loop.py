"""Identify the friction of one joint and search for missing effects: from logs to a report."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller, unknown_notes
from frictionjoint.control.reconstruct import check_drive
from frictionjoint.diagnose import report_parts as parts
from frictionjoint.diagnose.advice import what_to_record
from frictionjoint.diagnose.by_motion import named_by_motion
from frictionjoint.diagnose.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.kept_back import prepare_kept_back
from frictionjoint.diagnose.notes import DIVERGES, REFINED, gain_note, notes
from frictionjoint.diagnose.proposal import Planner, computed_proposals
from frictionjoint.diagnose.trace import trace
from frictionjoint.diagnose.verdict import noise_floor, verdict
from frictionjoint.identify.bodies import Bodies
from frictionjoint.identify.fit import Fit, with_gain
from frictionjoint.identify.gate import check, check_fit, load_shows, scale_is_determined
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.notes import other_drive_note
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import (
    law_estimates,
    law_parameters,
    units_of,
)
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.weights import errors_elsewhere, weighted
from frictionjoint.joint_friction import JointFriction
from frictionjoint.measured.log import JointLog
from frictionjoint.model_text import model_text
from frictionjoint.recordings.in_report import with_recordings
from frictionjoint.refine.motion import window_squares
from frictionjoint.refine.posterior import Posterior
from frictionjoint.refine.refine import Refined
from frictionjoint.refine.refined_model import RefinedModel, refined_in_windows
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import found_controller
from frictionjoint.replay.free_runs import (
    Replay,
    friction_of,
    friction_spec,
    replay,
    replay_rms,
    replayed_whole,
    simulated_whole,
)
from frictionjoint.replay.loops import Loops
from frictionjoint.report.joint_report import LogEntry, Report
from frictionjoint.threads import one_thread

# standard error of a gain over the gain, beyond which it may as well be any
_ANY_GAIN = 1.0
# where no torque is known, nothing can be replayed: before and after
_NO_REPLAY = [Rms(None, None), Rms(None, None)]


# free runs on fitted and on held-out logs
Runs = tuple[Replay, Replay | None]


@dataclass(frozen=True)
class Analysis:
    """Outcome of one joint.

    Attributes:
        simulated: the fit that the model contains. kept_back: held-out logs, weighted by the final
            fit. runs: of the first and of the final fit; None without a torque scale.
    """

    report: Report
    trace: Trace
    simulated: Fit
    kept_back: Prepared | None
    runs: tuple[Runs | None, Runs | None]


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
    mine, theirs = bodies.of(logs), bodies.of(held_out)
    body = mine[0]
    joint = body.joint
    said = bodies.check(logs, held_out)
    if controller:
        said += tuple(note for log in (*logs, *held_out) for note in check_drive(log, controller))
        said += unknown_notes(controller)
    progress("computing the torque of the model")
    fitted_on = prepare(list(logs), mine, controller=controller)
    check(fitted_on)
    kept_back = None
    if held_out:
        kept_back = prepare_kept_back(held_out, theirs, fitted_on.band, controller)
    said += other_drive_note(fitted_on, kept_back)

    loops = Loops.of(((logs, mine), (held_out, theirs)), controller) if controller else None

    def replayed(prepared: Prepared, fitted: Fit) -> Array | None:
        if loops is None:
            known = scale_is_determined(prepared, fitted)
            return replayed_whole(prepared, mine, fitted) if known else None
        if not load_shows(fitted):
            return None
        whole = simulated_whole(fitted, body.armature, in_closed_loop=True)
        return window_squares(loops.fit, fitted) if whole else None

    found = trace(fitted_on, seed, progress, law, replayed, by_motion=loops is not None)
    kept_as_fitted = found.as_fitted(kept_back) if kept_back else None
    shows = load_shows(found.final)
    if shows and not load_shows(found.base):
        # without the effects the drive may hide the load: the motor is that of the found model
        found = replace(found, base=with_gain(found.base, found.final.gain))
    scaled = shows and scale_is_determined(found.prepared, found.final)
    outcome, closed, refined = None, None, None
    if loops and shows:
        # if the load is weakly excited the gain is poorly determined: the best one, with its error
        if refine is not False:
            found, outcome = named_by_motion(found, loops.fit, body.armature, progress)
            scaled = scaled or (outcome.taken and outcome.gain_error < _ANY_GAIN)
            refined = RefinedModel.of(outcome, loops, body.slide, scaled)
        closed = loops.errors((found.base, found.final))
    elif refine and scaled and simulated_whole(found.final, body.armature, in_closed_loop=True):
        outcome = refined_in_windows(found.prepared, found.final, logs, mine, progress)
        refined = RefinedModel.of(outcome, None, body.slide, scaled)
    best = outcome.fit if outcome else found.final
    if not scaled:
        found = found.without_scale()
    check_fit(found.prepared, found.final)
    moving = found.prepared
    cov = stated_covariance(moving, found.final)
    left = errors_elsewhere(moving, found.final, cov)
    kept_moving = weighted(kept_as_fitted, found.final, left) if kept_as_fitted else None
    progress("simulating the logs")
    spec = body.spec()
    if scaled:
        friction_spec(spec, joint, best)
    spec.compile()
    if closed:  # the target drives the joint, as it will where the model is used
        after_it = (refined.loops if refined and refined.taken else None) or closed[1]
        runs = [loop.replays for loop in (closed[0], after_it)]
        positions = parts.followed_positions(closed[0], after_it)
    else:
        runs = [
            (replay(on, mine, f), replay(kept, theirs, f) if kept else None)
            for on, kept, f in (
                (fitted_on, kept_back, found.base),
                (moving, kept_as_fitted, best if scaled else found.final),
            )
            if scaled
        ]
        positions = parts.simulated_positions(moving, kept_as_fitted, runs)
    before, after = [replay_rms(*run) for run in runs] or _NO_REPLAY
    diverges = any(r is not None and r.diverges for r in (runs[1] if runs else ()))
    gain = found.final.scale
    torque = [parts.torque_rms(moving, kept_moving, f, gain) for f in (found.base, found.final)]
    entries = [LogEntry.of(log, "fit") for log in logs]
    entries += [LogEntry.of(log, "held-out") for log in held_out]
    final = law_estimates(found.final, cov, body.slide)
    open_questions = what_to_record(
        parts.ties(found), parts.forms(found), found.unexplained, final, bool(held_out)
    )
    progress("choosing what to record next")
    computed: Sequence[str] = ()
    if scaled:  # else no motion says which torque it asks of the drive
        planner = Planner(moving, found.final, body)
        computed = computed_proposals(planner, parts.rivals(found), cov, final)
    report = Report(
        joint=joint,
        slide=body.slide,
        units=units_of(found.final, body.slide),
        logs=tuple(entries),
        base=law_estimates(found.base, stated_covariance(moving, found.base), body.slide),
        final=final,
        before_torque=torque[0],
        before_replay=before,
        added=parts.added(found, cov, moving, kept_moving),
        after_torque=torque[1],
        after_replay=after,
        torque_interval=parts.intervals(kept_moving or moving, found),
        replay_interval=parts.replay_intervals(runs),
        measured_rms=found.final.target_rms,
        reconstructed=fitted_on.commanded,
        bandwidth_hz=fitted_on.band.balance,
        noise_floor=noise_floor(moving, found.final.gain),
        unexplained=found.unexplained,
        verdict=verdict(found, (torque[0], before), (torque[1], after), diverges),
        mjcf=model_text(spec, body.mjcf),
        seconds=time.perf_counter() - begin,
        laws=(law_parameters(found.base), law_parameters(found.final)),
        curves=parts.curves(moving, kept_moving, found),
        rankings=parts.rankings(found),
        thresholds={"gain": SMALLEST_GAIN, "p_value": SIGNIFICANCE},
        proposals=(*open_questions, *computed),
        notes=(
            *((DIVERGES,) if diverges else ()),
            *said,
            *notes(found, cov, shows),
            *((REFINED,) if refined and refined.taken and not closed else ()),
            *(gain_note(outcome.gain_error) if outcome and scaled else ()),
        ),
        closed_loops=(closed[0], closed[1]) if closed else None,
        refined=refined,
        posterior=_posterior(moving, found.final, cov, body, outcome) if scaled else None,
        controller=found_controller(controller, best, scaled) if controller else None,
        carried=friction_of(best) if scaled else None,
        positions=positions,
    )
    progress("comparing the recordings")
    loads = mine if ends else [*mine, *theirs]
    recordings = zip((*logs, *held_out), loads, strict=False)
    # the model of the report has the load of the first log
    alike = [log for log, load in recordings if load is body]
    if len(alike) < len(loads):
        note = f"Recordings are compared with each other only under the load of {logs[0].name}."
        report = replace(report, notes=(*report.notes, note))
    report = with_recordings(report, alike, body.named_poses)
    before_and_after = (runs[0], runs[1]) if runs else (None, None)
    simulated = best if scaled else found.final
    return Analysis(report, found, simulated, kept_moving, before_and_after)


def _posterior(
    prepared: Prepared, fitted: Fit, cov: Array, body: RigidBody, refined: Refined | None
) -> Posterior:
    """Posterior of the resulting model."""
    vector = Vector(prepared, fitted, cov, body.armature)
    values, spread = vector.start, vector.covariance(cov)
    if refined and refined.taken:
        vector, values, spread = refined.vector, refined.values, refined.cov

    def made(x: Array) -> JointFriction:
        # what the logs hardly tell may lie far outside of what is possible
        return friction_of(vector.fit(np.clip(x, vector.low, vector.high)))

    return Posterior.of(values, spread, made, vector.has_gain)
