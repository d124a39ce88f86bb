"""Plots of the report page, as plotly figures."""

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from frictionjoint.arrays import Array
from frictionjoint.diagnose.report_data import Curve, Report

_MOST_POINTS = 3000
MEASURED, BEFORE, AFTER = "#7f7f7f", "#d95f02", "#1b9e77"


def _thin(*columns: Array) -> tuple[Array, ...]:
    """Every k-th sample, so that a page stays small."""
    step = max(1, len(columns[0]) // _MOST_POINTS)
    return tuple(np.round(c[::step], 6) for c in columns)


def shown(report: Report) -> Curve:
    """The log the plots show: the first one held out, else the first."""
    return next((c for c in report.curves if c.role == "held-out"), report.curves[0])


def over_time(report: Report) -> go.Figure:
    """Measured and predicted torque, and the residual, over time."""
    c = shown(report)
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.06)
    t, m, b, a = _thin(c.time, c.measured, c.before, c.after)
    for name, y, colour in (("measured", m, MEASURED), ("before", b, BEFORE), ("after", a, AFTER)):
        figure.add_scatter(x=t, y=y, name=name, line={"color": colour, "width": 1.4}, row=1, col=1)
    for name, y, colour in (("before", m - b, BEFORE), ("after", m - a, AFTER)):
        figure.add_scatter(
            x=t, y=y, name=f"residual {name}", line={"color": colour, "width": 1}, row=2, col=1
        )
    figure.update_yaxes(title_text=f"torque, {_torque(report)}", row=1, col=1)
    figure.update_yaxes(title_text=f"residual, {_torque(report)}", row=2, col=1)
    figure.update_xaxes(title_text="time, s", row=2, col=1)
    return styled(figure, 520)


def planes(report: Report) -> go.Figure:
    """Torque against velocity and against position."""
    c = shown(report)
    figure = make_subplots(rows=1, cols=2, shared_yaxes=True, horizontal_spacing=0.04)
    v, q, m, b, a = _thin(c.velocity, c.position, c.measured, c.before, c.after)
    for column, x in ((1, v), (2, q)):
        for name, y, colour in (
            ("measured", m, MEASURED),
            ("before", b, BEFORE),
            ("after", a, AFTER),
        ):
            figure.add_scattergl(
                x=x,
                y=y,
                name=name,
                mode="markers",
                marker={"color": colour, "size": 3},
                showlegend=column == 1,
                row=1,
                col=column,
            )
    position = "m" if report.slide else "rad"
    figure.update_xaxes(title_text=f"velocity, {position}/s", row=1, col=1)
    figure.update_xaxes(title_text=f"position, {position}", row=1, col=2)
    figure.update_yaxes(title_text=f"torque, {_torque(report)}", row=1, col=1)
    return styled(figure, 420)


def residual_against(report: Report, quantity: str) -> go.Figure:
    """Residual before and after against a measured quantity, with its running mean."""
    x = np.concatenate([c.quantities[quantity] for c in report.curves if quantity in c.quantities])
    before, after = (
        np.concatenate(
            [c.measured - getattr(c, k) for c in report.curves if quantity in c.quantities]
        )
        for k in ("before", "after")
    )
    figure = go.Figure()
    xs, bs, as_ = _thin(x, before, after)
    for name, y, full, colour in (("before", bs, before, BEFORE), ("after", as_, after, AFTER)):
        figure.add_scattergl(
            x=xs, y=y, name=name, mode="markers", opacity=0.25, marker={"color": colour, "size": 3}
        )
        centres, means = _running_mean(x, full)
        figure.add_scatter(
            x=centres, y=means, name=f"mean {name}", line={"color": colour, "width": 3}
        )
    figure.update_xaxes(title_text=quantity)
    figure.update_yaxes(title_text=f"residual, {_torque(report)}")
    return styled(figure, 320)


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    edges = np.unique(np.quantile(x, np.linspace(0, 1, 41)))
    if len(edges) < 3:
        return np.array([float(x.mean())]), np.array([float(y.mean())])
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(index, minlength=len(edges) - 1), 1)
    mean = np.bincount(index, y, minlength=len(edges) - 1) / count
    return 0.5 * (edges[1:] + edges[:-1]), mean


def ranking(report: Report) -> go.Figure:
    """Held-out gain of every candidate at the first look."""
    rows = sorted(report.ranking[:12], key=lambda r: r[1])
    figure = go.Figure(
        go.Bar(
            x=[max(0.0, 100 * gain) for _, gain, _ in rows],
            y=[name for name, _, _ in rows],
            orientation="h",
            marker_color=[AFTER if p <= 0.05 else MEASURED for _, _, p in rows],
            text=[f"p = {p:.3g}" for _, _, p in rows],
        )
    )
    figure.update_xaxes(title_text="held-out gain, % of the residual's variance")
    return styled(figure, 90 + 28 * len(rows))


def _torque(report: Report) -> str:
    return "N" if report.slide else "N m"


def styled(figure: go.Figure, height: int) -> go.Figure:
    """The house style, on a background of its page's own."""
    figure.update_layout(
        height=height,
        margin={"l": 60, "r": 20, "t": 30, "b": 50},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"color": "#808080", "size": 13},
        legend={"orientation": "h", "y": 1.08},
    )
    figure.update_xaxes(gridcolor="rgba(128,128,128,0.2)", zerolinecolor="rgba(128,128,128,0.4)")
    figure.update_yaxes(gridcolor="rgba(128,128,128,0.2)", zerolinecolor="rgba(128,128,128,0.4)")
    return figure
