"""The report of one joint, from its logs and its model."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose import report_parts as parts
from frictionjoint.diagnose.advice import what_to_record
from frictionjoint.diagnose.joint_logs import JointLogs
from frictionjoint.diagnose.notes import DIVERGES, REFINED, gain_note, notes
from frictionjoint.diagnose.proposal import Planner, computed_proposals
from frictionjoint.diagnose.resulting_model import ResultingModel
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import law_estimates, law_parameters, units_of
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import ConstraintShape
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared
from frictionjoint.joint_friction import JointFriction
from frictionjoint.model_text import model_text
from frictionjoint.refine.posterior import Posterior
from frictionjoint.refine.refine import Refined
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import found_controller
from frictionjoint.replay.free_runs import Replay, friction_of, friction_spec, replay_rms
from frictionjoint.report.entries import LogEntry, SimulatedPosition
from frictionjoint.report.joint_report import Report

# free runs on fitted and on held-out logs
Runs = tuple[Replay, Replay | None]


def build_report(
    logs: JointLogs,
    model: ResultingModel,
    cov: Array,
    kept_back: Prepared | None,
    runs: Sequence[Runs],
    positions: tuple[SimulatedPosition, ...],
    begin: float,
) -> Report:
    """The report, without the comparison of the recordings.

    Args:
        cov: of the last fit to torque. kept_back: held-out logs, weighted by it.
        runs, positions: simulated by the first and the resulting model, see `close_loop`.
        begin: when the analysis began, on the clock of `time.perf_counter`.
    """
    found, body, moving, scaled = model.trace, logs.body, model.trace.prepared, model.scaled
    base, final = found.base, found.final
    spec = body.spec()
    if scaled:
        friction_spec(spec, body.joint, model.fit)
    spec.compile()
    # where no torque is known, nothing can be replayed
    before, after = [replay_rms(*run) for run in runs] or [Rms(None, None)] * 2
    diverges = any(r is not None and r.diverges for r in (runs[1] if runs else ()))
    torque = [parts.torque_rms(moving, kept_back, f, final.scale) for f in (base, final)]
    estimates = law_estimates(final, cov, body.slide)
    computed: dict[tuple[str, ...], str] = {}
    if scaled:  # otherwise the torque that a motion needs is unknown
        planner = Planner(moving, final, body)
        computed = computed_proposals(planner, parts.rivals(found), cov, estimates)
    unexplained = {name: found.causes.get(name, "") for name, _ in found.unexplained}
    ties = [(f.term.effect, other) for f in found.findings for other in f.ties]
    forms = [(f.term.effect, other) for f in found.findings for other in f.forms]
    open_questions = ties, forms, unexplained, estimates
    return Report(
        joint=body.joint,
        slide=body.slide,
        units=units_of(final, body.slide),
        logs=(
            *(LogEntry.of(log, "fit") for log in logs.fitted),
            *(LogEntry.of(log, "held-out") for log in logs.held_out),
        ),
        base=law_estimates(base, stated_covariance(moving, base), body.slide),
        final=estimates,
        before_torque=torque[0],
        before_replay=before,
        added=parts.added(found, cov, moving, kept_back),
        after_torque=torque[1],
        after_replay=after,
        torque_interval=parts.intervals(kept_back or moving, found),
        replay_interval=parts.replay_intervals(runs),
        measured_rms=final.target_rms,
        reconstructed=logs.prepared.commanded,
        bandwidth_hz=logs.prepared.band.balance,
        noise_floor=parts.noise_floor(moving, final.gain),
        unexplained=found.unexplained,
        unexplained_causes=found.causes,
        verdict=parts.verdict(found, (torque[0], before), (torque[1], after), diverges),
        mjcf=model_text(spec, body.mjcf),
        seconds=time.perf_counter() - begin,
        laws=(law_parameters(base), law_parameters(final)),
        curves=parts.curves(moving, kept_back, found),
        rankings=parts.rankings(found),
        smallest=() if found.detection_limit.too_short else found.detection_limit.of_each,
        law_errors={law_parameters(final).law: final.rms_in_motion} | dict(found.other_laws.errors),
        thresholds={"gain": SMALLEST_GAIN, "p_value": SIGNIFICANCE},
        proposals=what_to_record(*open_questions, bool(logs.held_out), computed),
        notes=(
            *((DIVERGES,) if diverges else ()),
            *logs.notes,
            *notes(found, cov, model.load_shows),
            *((REFINED,) if model.taken and not model.closed else ()),
            *(gain_note(model.outcome.gain_error) if model.outcome and scaled else ()),
        ),
        closed_loops=(model.closed[0], model.closed[1]) if model.closed else None,
        refined=model.refined,
        posterior=_posterior(moving, final, cov, body, model.outcome) if scaled else None,
        controller=found_controller(logs.controller, model.fit, scaled)
        if logs.controller
        else None,
        carried=friction_of(model.fit) if scaled else None,
        positions=positions,
    )


def _posterior(
    prepared: Prepared, fitted: Fit, cov: Array, body: RigidBody, refined: Refined | None
) -> Posterior:
    vector = Vector(prepared, fitted, cov, body.armature)
    values, spread = vector.start, vector.covariance(cov)
    if refined and refined.taken:
        found = refined.found
        vector, values, spread = found.vector, found.values, found.cov

    def made(x: Array) -> JointFriction:
        # what the logs do not determine may lie far outside of what is possible
        return friction_of(vector.fit(np.clip(x, vector.low, vector.high)))

    posterior, shape = Posterior.of(values, spread, made, vector.has_gain), fitted.shape
    constraint = shape.constraint if isinstance(shape, ConstraintShape) else None
    return replace(posterior, constraint=constraint)
