"""report.html: one self-contained page for a reader who did not make it."""

import math
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.advice import quantity
from frictionjoint.diagnose.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose.report_data import Looked, Report
from frictionjoint.report import plots, presliding, wording
from frictionjoint.report.figure import svg
from frictionjoint.report.html import fill

_CANDIDATES = 10


def render(report: Report, command: str) -> str:
    """The page as text; `command` is shown for making it again."""
    filters = {
        "figures": wording.three,
        "known_as": wording.known_as,
        "title": wording.title,
        "unit": wording.unit,
        "interval": wording.interval,
        "value": wording.value,
        "quantity": quantity,
    }
    torque, position = report.units
    filters["with_unit"] = lambda value: wording.stated(value, torque)
    turns = presliding.behind_turns(report)
    loop = plots.closed_loop(report)
    first, others = plots.quantities(report)
    return fill(
        "page.html.j2",
        filters,
        report=report,
        sentence=wording.sentence(report),
        held=report.after_torque.held_out is not None,
        errors=errors(report),
        drive=wording.drive(report),
        whose=wording.whose(report),
        smallest_gain=SMALLEST_GAIN,
        torque=torque,
        position=position,
        parameters=_parameters(report),
        logs=_logs(report),
        over_time=svg(plots.over_time(report, wide=True), "over-time"),
        over_time_narrow=svg(plots.over_time(report, wide=False), "over-time-narrow"),
        planes=[svg(plots.plane(report, x), f"plane-{x}") for x in ("velocity", "position")],
        closed_loop=svg(loop, "closed-loop") if loop is not None else "",
        loops=svg(presliding.loops(report), "loops"),
        turns=svg(turns, "turns") if turns is not None else "",
        rankings=[_ranking(look) for look in report.rankings if look.rows],
        residuals=[svg(plots.residual_against(report, x), f"residual-{x}") for x in first],
        neighbours=[svg(plots.residual_against(report, x), f"residual-{x}") for x in others],
        shown=plots.shown(report),
        command=command,
    )


def errors(report: Report) -> list[tuple[str, str, str, str]]:
    """Rows of the table: what, on fitted logs, held out, 95% interval."""
    torque, position = report.units
    first, last = (
        (wording.drive_rms(report, "fit", stage), wording.drive_rms(report, "held-out", stage))
        for stage in wording.STAGES
    )
    unknown = (math.nan, math.nan)
    rows = []
    drive = wording.drive(report)
    not_stated = (None, None)
    of_torque = report.torque_interval or not_stated
    of_replay = report.replay_interval or not_stated
    found = [
        ("before", drive, report.before_torque, of_torque[0], torque, first),
        ("after", drive, report.after_torque, of_torque[1], torque, last),
        ("before", "position", report.before_replay, of_replay[0], position, unknown),
        ("after", "position", report.after_replay, of_replay[1], position, unknown),
    ]
    for when, loop in zip(("before", "after"), report.closed_loops or (), strict=False):
        found.append((when, "position in closed loop", loop.mae, None, position, unknown))
    if report.refined:
        taken = "taken" if report.refined.taken else "not taken"
        what = f"position in closed loop, refined by simulation, {taken},"
        found.append(("after", what, report.refined.loops.mae, None, position, unknown))
    for when, what, rms, pair, unit, whole in found:
        if (rms.fit is None and rms.held_out is None) or (when == "before" and not report.changed):
            continue  # nothing was simulated, or it diverged: a note says so
        row = f"{what} {when}" if report.changed else what
        interval = f"{wording.interval(pair)}\u00a0{unit}" if pair else "not stated"
        fit, held_out = (
            wording.stated(x, unit, own)
            for x, own in zip((rms.fit, rms.held_out), whole, strict=True)
        )
        rows.append((row, fit, held_out, interval))
    return rows


def _ranking(look: Looked) -> list[dict[str, Any]]:
    """Leading candidates at a look, the best on top."""
    marks = {look.chosen: "added", look.runner_up: "runner-up"}
    rows = sorted(look.rows, key=lambda r: -r[1])[:_CANDIDATES]
    longest = max([10.0, *(100.0 * gain for _, gain, _ in rows)])
    return [
        {
            "name": name,
            "gain": max(0.0, 100.0 * gain),
            "width": max(0.0, 100.0 * 100.0 * gain / longest),
            "p": p,
            "beyond_chance": p <= SIGNIFICANCE,
            "mark": marks.get(name, "not added"),
        }
        for name, gain, p in rows
    ]


def _parameters(report: Report) -> list[dict[str, Any]]:
    """Rows of the table: the law before and after, then the effects."""
    rows = [
        {"name": n, "meaning": wording.meaning(n), "before": report.base.get(n), "after": x}
        for n, x in report.final.items()
    ]
    rows += [
        {"name": n, "meaning": wording.meaning(n), "before": x, "after": None}
        for n, x in report.base.items()
        if n not in report.final
    ]
    for added in report.added:
        rows += [
            {"name": n, "meaning": wording.known_as(added.effect), "before": None, "after": x}
            for n, x in added.parameters.items()
        ]
    return rows


def _logs(report: Report) -> list[dict[str, Any]]:
    """Each log with its own errors."""
    return [
        {"log": log, "before": _rms(c.measured - c.before), "after": _rms(c.measured - c.after)}
        for log, c in zip(report.logs, report.curves, strict=True)
    ]


def _rms(e: Array) -> float:
    return float(np.sqrt(np.mean(e**2)))
