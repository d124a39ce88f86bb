"""Plots of the report page."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.diagnose.report_data import Curve, Report
from frictionjoint.report.figure import AFTER, BEFORE, HALF, MEASURED, REFINED, WIDE, cloud, figure
from frictionjoint.report.wording import axis, drive, whose

# points of a line, and of a cloud
_LINE, _CLOUD = 3000, 4000
# Order in which a reader meets the quantities.
_ORDER = ("position", "velocity", "acceleration", "load", "time", "temperature_c")


def _thin(most: int, *columns: Array) -> tuple[NDArray[np.float64], ...]:
    """Every k-th sample, so that a page stays small."""
    step = -(-len(columns[0]) // most)
    return tuple(c[::step] for c in columns)


def shown(report: Report) -> Curve:
    """The log the plots show: the first one held out, else the first."""
    return next((c for c in report.curves if c.role == "held-out"), report.curves[0])


def stages(report: Report) -> tuple[tuple[str, str, str], ...]:
    """Label, attribute of a curve and colour of each prediction; one where nothing was changed."""
    if not report.changed:
        return (("law alone", "after", AFTER),)
    return ("before", "before", BEFORE), ("after", "after", AFTER)


def over_time(report: Report, wide: bool) -> Figure:
    """Measured and predicted torque, and the residual, over time."""
    c = shown(report)
    made, (above, below) = figure(WIDE if wide else HALF, 4.6, rows=2)
    t, m = (x.copy() for x in _thin(_LINE, c.time, c.measured))
    # no line across what was left out
    m[1:][np.diff(t) > 2.5 * np.median(np.diff(t))] = np.nan
    above.plot(t, m, color=MEASURED, linewidth=2.6, label=whose(report))
    for name, stage, colour in stages(report):
        (y,) = _thin(_LINE, getattr(c, stage))
        above.plot(t, np.where(np.isnan(m), np.nan, y), color=colour, linewidth=0.9, label=name)
        below.plot(t, m - y, color=colour, linewidth=0.9)
    above.set_ylabel(f"{drive(report)}, {report.units[0]}")
    below.set_ylabel(f"residual, {report.units[0]}")
    below.set_xlabel("time, s")
    return made


def closed_loop(report: Report) -> Figure | None:
    """Target, measured and simulated position of the log furthest off; None without controller."""
    if report.closed_loops is None:
        return None
    before, after = (x.held_out or x.fit for x in report.closed_loops)
    if before is None or after is None:
        return None
    refined = report.refined.loops if report.refined else None
    # the log that is furthest off is the one to look at
    i = int(np.argmax([float(np.mean(np.abs(e))) for e in after.errors]))
    course = after.courses[i]
    made, (axes,) = figure(HALF, 3.3)
    rows = [
        ("target", course.target, MEASURED, 0.8),
        ("measured", course.position, MEASURED, 2.6),
        ("before", before.simulated[i], BEFORE, 1.0),
        ("after", after.simulated[i], AFTER, 1.0),
    ]
    again = (refined.held_out or refined.fit) if refined else None
    if again is not None:
        rows.append(("refined", again.simulated[i], REFINED, 1.0))
    for name, x, colour, width in rows:
        if name == "before" and not report.changed:
            continue
        t, y = _thin(_LINE, course.time - course.time[0], x)
        axes.plot(t, y, ":" if name == "target" else "-", color=colour, lw=width, label=name)
    axes.set_xlabel(f"time, s, log {course.name}")
    axes.set_ylabel(axis("position", report.slide))
    return made


def plane(report: Report, quantity: str) -> Figure:
    """Torque against velocity or position, measured and predicted."""
    c = shown(report)
    made, (axes,) = figure(HALF, 3.7)
    for name, stage, colour in ((whose(report), "measured", MEASURED), *stages(report)):
        x, y = _thin(_CLOUD, getattr(c, quantity), getattr(c, stage))
        cloud(axes, x, y, colour, 3.6 if stage == "measured" else 1.8, name)
    axes.set_xlabel(axis(quantity, report.slide))
    axes.set_ylabel(f"{drive(report)}, {report.units[0]}")
    return made


def quantities(report: Report) -> tuple[list[str], list[str]]:
    """What the residual is drawn against: what it may depend on first, then the other joints'.

    A joint of an arm has many neighbours; those that explain nothing come second.
    """
    found = {name for c in report.curves for name in c.quantities}
    left = [name for name, _ in report.unexplained if name in found and name not in _ORDER]
    first = [n for n in _ORDER if n in found] + left
    return first, sorted(found - set(first))


def residual_against(report: Report, quantity: str) -> Figure:
    """Residual before and after against a measured quantity, with its running mean."""
    curves = [c for c in report.curves if quantity in c.quantities]
    x = np.concatenate([c.quantities[quantity] for c in curves])
    made, (axes,) = figure(HALF, 2.9)
    for name, stage, colour in stages(report):
        residual = np.concatenate([c.measured - getattr(c, stage) for c in curves])
        thin_x, thin_y = _thin(_CLOUD, x, residual)
        cloud(axes, thin_x, thin_y, f"{colour}48", 2.0)
        mean_x, mean_y = _running_mean(x, residual)
        axes.plot(mean_x, mean_y, color=colour, linewidth=2.2, label=f"mean, {name}")
    axes.set_xlabel(axis(quantity, report.slide))
    axes.set_ylabel(f"residual, {report.units[0]}")
    return made


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    edges = np.unique(np.quantile(x, np.linspace(0, 1, 41)))
    if len(edges) < 3:
        return np.array([float(x.mean())]), np.array([float(y.mean())])
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(index, minlength=len(edges) - 1), 1)
    mean = np.bincount(index, y, minlength=len(edges) - 1) / count
    return 0.5 * (edges[1:] + edges[:-1]), mean
