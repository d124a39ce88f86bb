"""report.html: one self-contained page for a reader who did not make it."""

from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.advice import quantity
from frictionjoint.diagnose.report_data import Report
from frictionjoint.diagnose.trace import SMALLEST_GAIN
from frictionjoint.report import plots, presliding, wording
from frictionjoint.report.html import fill, plot


def render(report: Report, command: str) -> str:
    """The page as text; `command` is shown for making it again."""
    filters = {
        "figures": wording.three,
        "interval": wording.interval,
        "value": wording.value,
        "quantity": quantity,
    }
    torque, position = report.units
    turns = presliding.behind_turns(report)
    loop = plots.closed_loop(report)
    first, others = plots.quantities(report)
    return fill(
        "page.html.j2",
        filters,
        report=report,
        sentence=wording.sentence(report),
        held=report.after_torque.held_out is not None,
        smallest_gain=SMALLEST_GAIN,
        torque=torque,
        position=position,
        parameters=_parameters(report),
        logs=_logs(report),
        over_time=plot(plots.over_time(report)),
        planes=[plot(plots.plane(report, x)) for x in ("velocity", "position")],
        closed_loop=plot(loop) if loop is not None else "",
        loops=plot(presliding.loops(report)),
        turns=plot(turns) if turns is not None else "",
        rankings=[plot(plots.ranking(look)) for look in report.rankings if look.rows],
        residuals=[plot(plots.residual_against(report, x)) for x in first],
        neighbours=[plot(plots.residual_against(report, x)) for x in others],
        shown=plots.shown(report),
        command=command,
    )


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
            {"name": f"{added.effect}: {n}", "meaning": "", "before": None, "after": x}
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
