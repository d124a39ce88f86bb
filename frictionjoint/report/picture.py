"""Charts drawn with matplotlib: `Report.plot`, and a report in Jupyter."""

import io
import math
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictionjoint.display import table
from frictionjoint.report import charts
from frictionjoint.report.joint_report import Report
from frictionjoint.report.robot_report import RobotReport
from frictionjoint.report.summary import Summary

COLOURS = {"measured": "#8a8f94", "target": "#7570b3", "before": "#d95f02", "after": "#1b9e77"}
_LAWS = "#1b9e77 #d95f02 #7570b3 #e7298a #66a61e #e6ab02 #a6761d #666666"
COLOURS |= dict(zip(charts.LAW_COLOURS, _LAWS.split(), strict=True))
# dashes let equal curves be seen
_DASHED = charts.LAW_COLOURS[1::2]
_STYLE: dict[Any, Any] = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "font.size": 9.5,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "svg.fonttype": "none",
}
# inches
_WIDE, _ROW = 10.0, 2.4


def draw(report: Report) -> Figure:
    """Friction-speed curve, then drive and position of the worst held-out stretch, with errors."""
    curve, window = charts.worst_stretch(report)
    rows: list[charts.Chart] = [charts.friction_speed(report)]
    rows += charts.drive_charts(report, curve, window, "", True)
    position = charts.worst_position(report)
    if position:
        rows += charts.position_charts(report, position, charts.worst_times(position), "")
    return draw_charts(rows, f"joint {report.joint}, log {curve.name}")


def draw_charts(rows: Sequence[charts.Chart], title: str) -> Figure:
    with rc_context(_STYLE):
        heights = [_ROW * (0.6 if c.low else 1.0) for c in rows]
        figure = Figure(figsize=(_WIDE, sum(heights)), layout="constrained")
        axes = figure.subplots(len(rows), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, chart in zip(axes, rows, strict=True):
            draw_chart(one, chart)
        figure.suptitle(title)
    return figure


def picture(figure: Figure, kind: str) -> bytes:
    """A figure as a file, "png" or "svg"."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, dpi=150)
    return buffer.getvalue()


def draw_robot(report: RobotReport) -> Figure:
    """Drive of the worst held-out stretch and friction-speed curve, one row per joint."""
    with rc_context(_STYLE):
        figure = Figure(figsize=(_WIDE, _ROW * len(report.joints)), layout="constrained")
        axes = figure.subplots(len(report.joints), 2, squeeze=False)
        for (left, right), (name, result) in zip(axes, report.joints.items(), strict=True):
            stretch = charts.worst_stretch(result)
            draw_chart(left, charts.drive_charts(result, *stretch, "", False)[0])
            draw_chart(right, charts.friction_speed(result))
            left.set_title(name)
    return figure


def draw_chart(axes: Axes, chart: charts.Chart) -> None:
    for s in chart.series:
        how: dict[str, Any] = {"color": COLOURS[s.colour], "label": s.name}
        if s.kind == "points":
            axes.plot(s.x, s.y, "o", **how, markersize=2.0, markeredgewidth=0.0, rasterized=True)
        else:
            width = 2.4 if s.colour == "measured" else 1.2
            style = ":" if s.colour == "target" else "--" if s.colour in _DASHED else "-"
            axes.plot(s.x, s.y, style, **how, linewidth=width)
    axes.set_xlabel(chart.x_label)
    axes.set_ylabel(chart.y_label)
    axes.ticklabel_format(scilimits=(-4, 5))
    axes.legend(fontsize=8, ncols=math.ceil(len(chart.series) / 2))


def report_html(report: Report) -> str:
    """Verdict, friction numbers and picture as HTML without a style sheet that loads nothing."""
    s = Summary(report.to_dict())
    lines = "".join(f"<p><b>{escape(k)}:</b> {escape(text)}</p>" for k, text in s.verdict_lines)
    rows = [(x.meaning, x.qualified) for x in s.friction]
    numbers = table(f"friction of joint {report.joint}", ("", "value"), rows)
    image = b64encode(picture(draw(report), "png")).decode()
    return f'{lines}{numbers}<img style="max-width: 60rem" src="data:image/png;base64,{image}">'
