"""report.html: one self-contained page for a reader who did not make it."""

import platform
from importlib.metadata import version
from importlib.resources import files
from typing import Any

import numpy as np
import plotly.graph_objects as go
from jinja2 import Environment
from plotly.offline import get_plotlyjs

from frictionjoint.arrays import Array
from frictionjoint.diagnose.advice import quantity
from frictionjoint.diagnose.loop import SMALLEST_GAIN
from frictionjoint.diagnose.report_data import Report
from frictionjoint.report import plots, presliding, wording

_MADE_BY = ("frictionjoint", "mujoco", "numpy", "scipy", "numba")


def render(report: Report, command: str) -> str:
    """The page as text; `command` is shown as the way to make it again."""
    template = files("frictionjoint.report").joinpath("page.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {
        "figures": wording.three,
        "interval": wording.interval,
        "value": wording.value,
        "quantity": quantity,
    }
    torque, position = wording.units(report)
    turns = presliding.behind_turns(report)
    return environment.from_string(template).render(
        report=report,
        sentence=wording.sentence(report),
        held=report.after_torque.held_out is not None,
        smallest_gain=SMALLEST_GAIN,
        torque=torque,
        position=position,
        parameters=_parameters(report),
        logs=_logs(report),
        over_time=_html(plots.over_time(report)),
        planes=[_html(plots.plane(report, x)) for x in ("velocity", "position")],
        loops=_html(presliding.loops(report)),
        turns=_html(turns) if turns is not None else "",
        ranking=_html(plots.ranking(report)) if report.ranking else "",
        residuals=[_html(plots.residual_against(report, x)) for x in plots.quantities(report)],
        shown=plots.shown(report),
        command=command,
        plotly=get_plotlyjs(),
        versions=[(name, version(name)) for name in _MADE_BY]
        + [("Python", platform.python_version())],
    )


def _parameters(report: Report) -> list[dict[str, Any]]:
    """Rows of the table: the law before and after, then the effects."""
    rows = [
        {"name": n, "meaning": wording.meaning(n), "before": report.base.get(n), "after": x}
        for n, x in report.final.items()
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


def _html(figure: go.Figure) -> str:
    return str(
        figure.to_html(
            full_html=False,
            include_plotlyjs=False,
            config={"responsive": True, "displayModeBar": False},
        )
    )
