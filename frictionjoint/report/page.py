"""report.html: one self-contained page for a reader who did not make it."""

import platform
from importlib.metadata import version
from importlib.resources import files

import plotly.graph_objects as go
from jinja2 import Environment
from plotly.offline import get_plotlyjs

from frictionjoint.diagnose.close_loop import estimates_table
from frictionjoint.diagnose.report_data import Report
from frictionjoint.report import plots


def render(report: Report, command: str) -> str:
    """The page as text; `command` is shown as the way to make it again."""
    template = files("frictionjoint.report").joinpath("page.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["figures"] = _three_figures
    quantities = sorted({name for c in report.curves for name in c.quantities})
    return environment.from_string(template).render(
        report=report,
        sentence=sentence(report),
        torque="N" if report.slide else "N m",
        position="m" if report.slide else "rad",
        parameters=estimates_table(report),
        over_time=_html(plots.over_time(report)),
        planes=_html(plots.planes(report)),
        ranking=_html(plots.ranking(report)) if report.ranking else "",
        residuals=[(name, _html(plots.residual_against(report, name))) for name in quantities],
        shown=plots.shown(report),
        command=command,
        plotly=get_plotlyjs(),
        versions=[(name, version(name)) for name in ("frictionjoint", "mujoco", "numpy")]
        + [("Python", platform.python_version())],
    )


def sentence(report: Report) -> str:
    """The verdict in a sentence."""
    where = "held-out" if report.after_torque.held_out is not None else "fitted"
    before = report.before_torque.held_out or report.before_torque.fit or 0.0
    after = report.after_torque.held_out or report.after_torque.fit or 0.0
    unit = "N" if report.slide else "N m"
    names = ", ".join(a.effect for a in report.added)
    left = ", ".join(v for v, _ in report.unexplained)
    if report.verdict == "no-effect-found":
        return (
            f"Nothing is missing that these logs can show: the law alone leaves {before:.3g} "
            f"{unit} on {where} data, and no known effect takes a justified share of it."
        )
    change = f"the error falls from {before:.3g} to {after:.3g} {unit} on {where} data"
    found = (
        f"The model lacked {names}: with it {change}"
        if names
        else f"No known effect fits: {change}"
    )
    if report.verdict == "partly-explained":
        rest = f"still depends on {left}" if left else "is not noise alone"
        return f"{found}, and what is left {rest}."
    return f"{found}."


def _html(figure: go.Figure) -> str:
    return str(
        figure.to_html(
            full_html=False,
            include_plotlyjs=False,
            config={"responsive": True, "displayModeBar": False},
        )
    )


def _three_figures(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"
