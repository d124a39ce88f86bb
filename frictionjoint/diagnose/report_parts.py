"""Parts of a report, made from the findings of the search: figures, candidates, the verdict."""

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.decisions import AS_WHITE, AT_THE_FLOOR, LEAST_NOISE, SURELY
from frictionjoint.diagnose.determined import offset_instead, standard_errors
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.moves import Look
from frictionjoint.effects.signals import TIME, Q, V
from frictionjoint.identify.blocks import correlation_time
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import rms_interval
from frictionjoint.identify.result import term_estimates
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import VARIABLES
from frictionjoint.identify.start import predict
from frictionjoint.identify.terms import DriveTerm, Term
from frictionjoint.replay.closed_loop import LoopErrors
from frictionjoint.replay.free_runs import Replay
from frictionjoint.replay.windows import RUN_S
from frictionjoint.report.entries import (
    Added,
    Curve,
    Evidence,
    Intervals,
    Looked,
    Ranked,
    Role,
    SimulatedPosition,
)
from frictionjoint.report.joint_report import Verdict

# ratio of the noise of two logs beyond which one contains torque above its band; the noise of a
# short log is known to 10%
_SAME_NOISE = 1.5


def _errors(prepared: Prepared, fitted: Fit, gain: float) -> Array:
    """Errors of the torque in motion, N m, all with one drive gain: a smaller gain improves no
    model."""
    found = predict(prepared, fitted)
    return np.asarray(found.error[found.in_motion] * (gain / fitted.scale))


def torque_rms(fitted_on: Prepared, kept_back: Prepared | None, f: Fit, gain: float) -> Rms:
    """rms error of the torque in motion with a drive gain, fitted and held out, N m (N)."""
    held = root_mean_square(_errors(kept_back, f, gain)) if kept_back else None
    return Rms(root_mean_square(_errors(fitted_on, f, gain)), held)


def intervals(prepared: Prepared, found: Trace) -> Intervals | None:
    """Intervals of the torque's rms error before and after; None if there are too few blocks."""
    first = prepared.segments[0]
    length = max(1, round(RUN_S / (first.dt * first.step)))
    errors = [_errors(prepared, f, found.final.scale) for f in (found.base, found.final)]
    if min(map(len, errors)) < 5 * length:  # the spread of fewer blocks tells nothing
        return None
    before, after = (rms_interval(e, np.arange(len(e)) // length) for e in errors)
    return before, after


def replay_intervals(runs: Sequence[tuple[Replay, Replay | None]]) -> Intervals | None:
    """Intervals of the replay's rms error before and after; each free run is one block."""
    pair = []
    if not runs or any(r is not None and r.diverges for run in runs for r in run):
        return None
    for fit_run, held_run in runs:
        e = np.concatenate((held_run or fit_run).errors)
        known = np.isfinite(e)
        run = np.cumsum(~known)[known]
        if not len(run) or run[0] == run[-1]:  # one run alone says nothing of their spread
            return None
        pair.append(rms_interval(e[known], run))
    return pair[0], pair[1]


def added(
    found: Trace, cov: Array, fitted_on: Prepared, kept_back: Prepared | None
) -> tuple[Added, ...]:
    """One entry per effect; further harmonics of a periodic effect join that of the first."""
    entries: dict[str, Added] = {}
    for i, step in enumerate(found.findings):
        parameters = term_estimates(found.final, cov, i, fitted_on.slide)
        name = step.term.name
        rms = torque_rms(fitted_on, kept_back, step.fit, found.final.scale)
        if name in entries:
            first = entries[name]
            number = 1 + sum(s.term.name == name for s in found.findings[:i])
            more = {f"{key}_{number}": x for key, x in parameters.items()}
            entries[name] = replace(first, parameters=first.parameters | more, torque_rms=rms)
        else:
            turned = offset_instead(found.prepared, parameters) is not None
            ties = (*step.ties, "joint-offset") if turned else step.ties
            evidence = Evidence(
                *(step.gain, step.row.p_value, step.row.frequency),
                *step.runner_up,
                ties,
                standard_errors(found.final, cov, i) < SURELY,
            )
            entries[name] = Added(name, step.term.effect.cause, parameters, evidence, rms)
    return tuple(entries.values())


def curves(fitted_on: Prepared, kept_back: Prepared | None, found: Trace) -> tuple[Curve, ...]:
    """Torque and its errors along each log, before and after."""
    curves = []
    for role, prepared in zip(get_args(Role), (fitted_on, kept_back), strict=True):
        if prepared is None:
            continue
        # Where the drive's gain is fitted, the measured torque is the final model's, and so is the
        # gain that the residual before is stated by.
        scale = found.final.scale / found.base.scale
        own, base, *_ = predict(prepared, found.base)
        last = predict(prepared, found.final)
        moving = np.split(last.in_motion, np.cumsum([len(m) for m in last.measured])[:-1])
        for i, s in enumerate(prepared.segments):
            kept = s.at_kept(s.signals)
            quantities = {name: kept[:, column] for name, column in VARIABLES.items()}
            quantities |= {name: s.at_kept(x) for name, x in s.others.items()}
            measured, given = last.measured[i], own[i] * scale
            curves.append(
                Curve(
                    *(s.name, role, kept[:, TIME], kept[:, Q], kept[:, V], given, measured),
                    before=measured - given + base[i] * scale,
                    after=last.predicted[i],
                    friction=last.friction[i],
                    in_motion=moving[i],
                    quantities={n: x for n, x in quantities.items() if np.ptp(x) > 0.0},
                )
            )
    return tuple(curves)


def simulated_positions(
    fitted_on: Prepared, kept_back: Prepared | None, runs: Sequence[tuple[Replay, Replay | None]]
) -> tuple[SimulatedPosition, ...]:
    """Measured and replayed position of each log.

    Args:
        runs: before and after, of fitted and of held-out logs.
    """
    found = []
    for role, prepared, before, after in zip(
        get_args(Role), (fitted_on, kept_back), *runs, strict=True
    ):
        if prepared is None or before is None or after is None:
            continue
        for s, b, a in zip(prepared.segments, before.errors, after.errors, strict=True):
            q, time = s.signals[:, Q], s.signals[:, TIME]
            simulated = [q + np.where(np.isfinite(e), e, np.nan) for e in (b, a)]
            found.append(SimulatedPosition(s.name, role, time, q, *simulated))
    return tuple(found)


def followed_positions(before: LoopErrors, after: LoopErrors) -> tuple[SimulatedPosition, ...]:
    """Target, measured and simulated position of each log in closed loop."""
    found = []
    pairs = (before.fit, after.fit), (before.held_out, after.held_out)
    for role, (first, last) in zip(get_args(Role), pairs, strict=True):
        if first is None or last is None:
            continue
        for c, b, a in zip(last.courses, first.simulated, last.simulated, strict=True):
            time = c.time - c.time[0]
            found.append(SimulatedPosition(c.name, role, time, c.position, b, a, c.target))
    return tuple(found)


def rankings(found: Trace) -> tuple[Looked, ...]:
    """Candidates of each step of the search."""

    def rows(look: Look) -> tuple[Ranked, ...]:
        named = (r for r in look.rows if not r.candidate.unnamed)
        return tuple(Ranked(r.name, look.gain(r), r.p_value) for r in named)

    looks = [Looked(f.term.name, f.runner_up[0], rows(f.look)) for f in found.findings]
    return tuple(looks) or (Looked(None, None, rows(found.last_look)),)


def rivals(found: Trace) -> list[tuple[int, Term]]:
    """Effects that explain nearly as much, by the index of a term in the final fit."""
    taken = {f.term.name for f in found.findings}
    return [
        (i, term)
        for i, f in enumerate(found.findings)
        for term in f.rivals
        if term.name not in taken
        and not isinstance(term, DriveTerm)
        and not isinstance(f.term, DriveTerm)
    ]


def noise_floor(prepared: Prepared, gain: float) -> float:
    """Residual of a perfect model due to instrument noise in the torque band, N m.

    The torque's noise is estimated above the motion's band, where jerks and chatter of a stiff
    controller add to it. Logs share their instruments, so the quietest log determines the noise.
    """
    least = min((x for s in prepared.segments if (x := s.noise.torque) > 0.0), default=0.0)
    powers = []
    for s in prepared.segments:
        torque, position = s.noise.left(s.bandwidth_hz)
        if s.noise.torque > _SAME_NOISE * least:
            torque *= least / s.noise.torque
        powers.append(torque + position)
    return gain * float(np.sqrt(np.mean(powers)))


def verdict(
    found: Trace, before: tuple[Rms, Rms], after: tuple[Rms, Rms], diverges: bool
) -> Verdict:
    """`explained` requires a residual at the level of the instrument noise, or as white as noise
    where that level is unknown.

    It is not given if held-out logs or the replay contradict it or have more than twice the torque
    error, if the replay diverges, or if an added parameter reached the end of its range.

    Args:
        before, after: errors of torque and replay.
        diverges: whether a replay of the final model leaves the measured motion altogether.
    """
    if not found.findings and not found.unexplained:
        return "too-short-to-tell" if found.detection_limit.too_short else "no-effect-found"
    worse = diverges or any(a.worse_than(b) for b, a in zip(before, after, strict=True))
    contradicted = worse or after[0].only_fitted
    if not found.findings or found.unexplained or contradicted:
        return "partly-explained"
    final = found.final
    effects = (final.layout.of_term(i) for i in range(len(final.effects)))
    if any(bool(final.bound[at].any()) for at in effects):
        return "partly-explained"
    noise, left = noise_floor(found.prepared, final.gain), final.rms_in_motion
    # an error far below an estimate of the noise contradicts the estimate
    if noise < LEAST_NOISE * final.target_rms or left < noise / AT_THE_FLOOR:
        as_noise = _is_white(final, found.prepared)
    else:
        as_noise = left <= AT_THE_FLOOR * noise
    return "explained" if as_noise else "partly-explained"


def _is_white(fitted: Fit, prepared: Prepared) -> bool:
    """Whether the correlation time of a residual is near that of filtered white noise."""
    e = fitted.residual * fitted.weight
    for i, s in enumerate(prepared.segments):
        filtered_noise = max(1.0, 1.0 / (2.0 * s.bandwidth_hz * s.dt * s.step))
        if correlation_time(e[fitted.log_index == i]) > AS_WHITE * filtered_noise:
            return False
    return True
