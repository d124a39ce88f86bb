"""Plots of the report page, as plotly figures."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from frictionjoint.arrays import Array
from frictionjoint.diagnose.report_data import Curve, Looked, Report
from frictionjoint.diagnose.trace import SMALLEST_GAIN
from frictionjoint.report.wording import axis

# Points of a line, and of a cloud: each point of a cloud is an element of the page.
_LINE, _CLOUD = 3000, 1200
_CANDIDATES = 10
MEASURED, BEFORE, AFTER, REFINED = "#8a8f94", "#d95f02", "#1b9e77", "#7570b3"
# Order in which a reader meets the quantities.
_ORDER = ("position", "velocity", "acceleration", "load", "time", "temperature_c")


def _thin(most: int, *columns: Array) -> tuple[NDArray[np.float32], ...]:
    """Every k-th sample in single precision, so that a page stays small."""
    step = -(-len(columns[0]) // most)
    return tuple(c[::step].astype(np.float32) for c in columns)


def shown(report: Report) -> Curve:
    """The log the plots show: the first one held out, else the first."""
    return next((c for c in report.curves if c.role == "held-out"), report.curves[0])


def stages(report: Report) -> tuple[tuple[str, str, str], ...]:
    """Label, attribute of a curve and colour of each prediction; one where nothing was changed."""
    if not report.changed:
        return (("law alone", "after", AFTER),)
    return ("before", "before", BEFORE), ("after", "after", AFTER)


def over_time(report: Report) -> go.Figure:
    """Measured and predicted torque, and the residual, over time."""
    c = shown(report)
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.06)
    t, m = _thin(_LINE, c.time, c.measured)
    # no line across what was left out
    m[1:][np.diff(t) > 2.5 * np.median(np.diff(t))] = np.nan
    line: dict[str, Any] = {"color": MEASURED, "width": 3.5}
    figure.add_scatter(x=t, y=m, name="measured", line=line, row=1, col=1)
    for name, stage, colour in stages(report):
        (y,) = _thin(_LINE, getattr(c, stage))
        y[np.isnan(m)] = np.nan
        line = {"color": colour, "width": 1.3}
        figure.add_scatter(x=t, y=y, name=name, line=line, row=1, col=1)
        figure.add_scatter(
            x=t, y=m - y, line=line, showlegend=False, name=f"residual, {name}", row=2, col=1
        )
    torque, _ = report.units
    figure.update_yaxes(title_text=f"torque, {torque}", row=1, col=1)
    figure.update_yaxes(title_text=f"residual, {torque}", row=2, col=1)
    figure.update_xaxes(title_text="time, s", row=2, col=1)
    return styled(figure, 520)


def closed_loop(report: Report) -> go.Figure | None:
    """Target, measured and simulated position of the log shown; None without a controller."""
    if report.closed_loops is None:
        return None
    before, after = (x.held_out or x.fit for x in report.closed_loops)
    if before is None or after is None:
        return None
    refined = report.refined.loops if report.refined else None
    # the log that is furthest off is the one to look at
    i = int(np.argmax([float(np.mean(np.abs(e))) for e in after.errors]))
    course = after.courses[i]
    figure = go.Figure()
    rows: list[tuple[str, Array, dict[str, Any]]] = [
        ("target", course.target, {"color": MEASURED, "width": 1, "dash": "dot"}),
        ("measured", course.position, {"color": MEASURED, "width": 3.5}),
    ]
    if report.changed:
        rows.append(("before", before.simulated[i], {"color": BEFORE, "width": 1.3}))
    rows.append(("after", after.simulated[i], {"color": AFTER, "width": 1.3}))
    again = (refined.held_out or refined.fit) if refined else None
    if again is not None:
        rows.append(("refined", again.simulated[i], {"color": REFINED, "width": 1.3}))
    for name, x, line in rows:
        t, y = _thin(_LINE, course.time - course.time[0], x)
        figure.add_scatter(x=t, y=y, name=name, line=line)
    figure.update_xaxes(title_text=f"time, s, log {course.name}")
    figure.update_yaxes(title_text=axis("position", report.slide))
    return styled(figure, 400)


def plane(report: Report, quantity: str) -> go.Figure:
    """Torque against velocity or position, measured and predicted."""
    c = shown(report)
    figure = go.Figure()
    rows = (("measured", "measured", MEASURED), *stages(report))
    for name, stage, colour in rows:
        x, y = _thin(_CLOUD, getattr(c, quantity), getattr(c, stage))
        marker = {"color": colour, "size": 6 if stage == "measured" else 3}
        figure.add_scatter(x=x, y=y, name=name, mode="markers", marker=marker)
    figure.update_xaxes(title_text=axis(quantity, report.slide))
    figure.update_yaxes(title_text=f"torque, {report.units[0]}")
    return styled(figure, 400)


def quantities(report: Report) -> tuple[list[str], list[str]]:
    """What the residual is drawn against: what it may depend on first, then the other joints'.

    A joint of an arm has many neighbours; those that explain nothing come second.
    """
    found = {name for c in report.curves for name in c.quantities}
    left = [name for name, _ in report.unexplained if name in found and name not in _ORDER]
    first = [n for n in _ORDER if n in found] + left
    return first, sorted(found - set(first))


def residual_against(report: Report, quantity: str) -> go.Figure:
    """Residual before and after against a measured quantity, with its running mean."""
    curves = [c for c in report.curves if quantity in c.quantities]
    x = np.concatenate([c.quantities[quantity] for c in curves])
    figure = go.Figure()
    for name, stage, colour in stages(report):
        residual = np.concatenate([c.measured - getattr(c, stage) for c in curves])
        points = dict(zip("xy", _thin(_CLOUD, x, residual), strict=True))
        figure.add_scatter(
            **points,
            name=name,
            mode="markers",
            opacity=0.3,
            showlegend=False,
            marker={"color": colour, "size": 3},
        )
        mean = dict(zip("xy", _running_mean(x, residual), strict=True))
        figure.add_scatter(
            **mean, name=f"mean, {name}", mode="lines", line={"color": colour, "width": 3}
        )
    figure.update_xaxes(title_text=axis(quantity, report.slide))
    figure.update_yaxes(title_text=f"residual, {report.units[0]}")
    return styled(figure, 300)


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    edges = np.unique(np.quantile(x, np.linspace(0, 1, 41)))
    if len(edges) < 3:
        return np.array([float(x.mean())]), np.array([float(y.mean())])
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(index, minlength=len(edges) - 1), 1)
    mean = np.bincount(index, y, minlength=len(edges) - 1) / count
    return 0.5 * (edges[1:] + edges[:-1]), mean


def ranking(look: Looked) -> go.Figure:
    """Held-out gain of the leading candidates at a look, the best on top."""
    rows = sorted(look.rows[:_CANDIDATES], key=lambda r: r[1])
    marks = {look.chosen: "chosen, ", look.runner_up: "runner-up, "}
    gains = [100 * max(0.0, gain) for _, gain, _ in rows]
    most = max([10.0, *gains])
    figure = go.Figure(
        go.Bar(
            x=gains,
            y=[name for name, _, _ in rows],
            orientation="h",
            marker_color=[AFTER if p <= 0.05 else MEASURED for _, _, p in rows],
            text=[f"{marks.get(name, '')}p {p:.2g}" for name, _, p in rows],
            textposition=["inside" if x > 0.6 * most else "outside" for x in gains],
            cliponaxis=False,
        )
    )
    figure.add_vline(100 * SMALLEST_GAIN, line={"color": BEFORE, "dash": "dot", "width": 1.5})
    figure.update_xaxes(title_text="held-out gain, %", range=[0.0, 1.02 * most])
    figure.update_yaxes(automargin=True)
    return styled(figure, 90 + 28 * len(rows))


def styled(figure: go.Figure, height: int) -> go.Figure:
    """The house style, on a background of its page's own."""
    figure.update_layout(
        height=height,
        margin={"l": 60, "r": 15, "t": 40, "b": 50},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"color": "#808080", "size": 13, "family": "system-ui, sans-serif"},
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "itemsizing": "constant"},
    )
    lines: dict[str, Any] = {
        "gridcolor": "rgba(128,128,128,0.2)",
        "zerolinecolor": "rgba(128,128,128,0.4)",
    }
    figure.update_xaxes(**lines)
    figure.update_yaxes(**lines)
    return figure


def lines(
    figure: go.Figure, curves: Sequence[tuple[Array, Array]], colour: str, name: str
) -> go.Figure:
    """Several curves as one entry of the legend."""
    gap = np.array([np.nan])
    x, y = (np.concatenate([part for c in curves for part in (c[i], gap)]) for i in (0, 1))
    line = {"color": colour, "width": 2}
    return figure.add_scatter(x=x, y=y, name=name, mode="lines", line=line, connectgaps=False)
