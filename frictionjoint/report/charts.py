"""Charts of a report as data: the page draws them on a canvas, `Report.plot` with matplotlib."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.identify.smooth import VARIABLES
from frictionjoint.law.motion import friction_torque, presliding_distance
from frictionjoint.parameters import Friction
from frictionjoint.report.entries import Curve, SimulatedPosition
from frictionjoint.report.error_figures import STAGES, Stage
from frictionjoint.report.joint_report import Report
from frictionjoint.report.wording import axis, drive_name

Kind = Literal["line", "points"]
# colours of the style sheet
LawColour = Literal["law0", "law1", "law2", "law3", "law4", "law5", "law6", "law7"]
Colour = Literal["measured", "before", "after", "target"] | LawColour
LAW_COLOURS: tuple[LawColour, ...] = get_args(LawColour)

# points of a line or a cloud, so that a page stays small
_POINTS = 3000
# samples needed before sliding at a steady speed is reached, and its longest path, rad (m)
_PATH = np.concatenate([[0.0], np.geomspace(1e-9, 10.0, 800)])


@dataclass(frozen=True)
class Series:
    """One curve or cloud; x and y of shape (n,)."""

    name: str
    x: Array
    y: Array
    colour: Colour
    kind: Kind = "line"


@dataclass(frozen=True)
class Chart:
    """One plot. Charts of one `group` are zoomed along x together."""

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    group: str = ""
    low: bool = False


def worst_stretch(report: Report) -> tuple[Curve, slice]:
    """The held-out log (else a fitted one) and its samples with the largest error of the drive."""
    curves = [c for c in report.curves if c.role == "held-out"] or list(report.curves)
    found = [_worst(c.time, np.where(c.in_motion, c.measured - c.after, np.nan)) for c in curves]
    k = int(np.argmax([error for _, error in found]))
    return curves[k], found[k][0]


def _worst(time: Array, error: Array) -> tuple[slice, float]:
    """The stretch of a log with the largest mean square of an error, and that; NaN counts as 0."""
    # 2 s, or 15% of the log
    size = max(2.0, 0.15 * float(time[-1] - time[0]))
    best = slice(0, len(time)), -1.0
    total = np.concatenate([[0.0], np.cumsum(np.nan_to_num(error) ** 2)])
    known = np.concatenate([[0], np.cumsum(np.isfinite(error))])
    for begin in np.linspace(time[0], max(time[0], time[-1] - size), 60):
        a, b = np.searchsorted(time, [begin, begin + size])
        mean = float(total[b] - total[a]) / max(1, b - a)
        if known[b] - known[a] >= 2 and mean > best[1]:
            best = slice(int(a), int(b)), mean
    return best


def drive_charts(
    report: Report, c: Curve, w: slice, group: str, before: bool
) -> tuple[Chart, Chart]:
    """Measured and predicted drive, and the error, over time in some samples of a log."""
    name, unit = drive_name(report.units[0], report.slide), report.units[0]
    source = "controller’s" if report.reconstructed else "measured"
    above = [over_time(source, c.time[w], c.measured[w], "measured")]
    below = []
    for label, stage in _stages(report, "predicted"):
        if before or stage == "after":
            y = getattr(c, stage)
            above.append(over_time(label, c.time[w], y[w], stage))
            below.append(over_time(label, c.time[w], (c.measured - y)[w], stage))
    error = f"Error ({source} − predicted)"
    return (
        Chart(name.capitalize(), "time, s", f"{name}, {unit}", tuple(above), group),
        Chart(error, "time, s", unit, tuple(below), group, low=True),
    )


def _stages(report: Report, unchanged: str) -> list[tuple[str, Stage]]:
    """Label and stage of each prediction: before and after, or one with a label of its own."""
    return [(x, x) for x in STAGES] if report.changed else [(unchanged, "after")]


def position_charts(
    report: Report, found: SimulatedPosition, times: tuple[float, float] | None, group: str
) -> tuple[Chart, Chart]:
    """Measured and simulated position, and the error, over time between two `times`, s; None for
    the whole log."""
    on = np.ones(len(found.time), dtype=bool)
    if times:
        on = (found.time >= times[0]) & (found.time <= times[1])
    unit = report.units[1] if report.units[1] in ("rad", "m") else "rad"
    t, q = found.time[on], found.measured[on]
    above = [over_time("measured", t, q, "measured")]
    if found.target is not None:
        above.append(over_time("target", t, found.target[on], "target"))
    below = []
    for label, stage in _stages(report, "simulated"):
        x = getattr(found, stage)[on]
        above.append(over_time(label, t, x, stage))
        below.append(over_time(label, t, x - q, stage))
    return (
        Chart("Position", "time, s", f"position, {unit}", tuple(above), group),
        Chart("Error (simulated − measured)", "time, s", unit, tuple(below), group, low=True),
    )


def worst_position(report: Report) -> SimulatedPosition | None:
    """The held-out log (else a fitted one) with the largest position error."""
    held = [x for x in report.positions if x.role == "held-out"] or list(report.positions)
    errors = [_rms(x.after - x.measured) for x in held]
    return held[int(np.argmax(errors))] if held else None


def worst_times(found: SimulatedPosition) -> tuple[float, float]:
    """First and last time, s, of the stretch of a log with the largest position error."""
    return ends_of(found.time[_worst(found.time, found.after - found.measured)[0]])


def ends_of(time: Array) -> tuple[float, float]:
    """First and last time."""
    return float(time[0]), float(time[-1])


def friction_speed(report: Report) -> Chart:
    """Friction against speed: the fitted law, and the data without the rest of the model."""
    moving = [c for c in report.curves if c.in_motion.any()] or list(report.curves)
    v = np.concatenate([c.velocity[c.in_motion] for c in moving])
    F = np.concatenate([(c.measured - c.after + c.friction)[c.in_motion] for c in moving])
    fastest = float(np.abs(v).max()) if len(v) else 1.0
    speeds, law = sliding(report.laws[1], fastest)
    return Chart(
        "Friction against speed",
        axis("velocity", report.slide),
        f"friction, {report.units[0]}",
        (cloud("data", v, F, "measured"), Series("law, sliding", speeds, law, "after")),
    )


def sliding(law: Friction, fastest: float, points: int = 40) -> tuple[Array, Array]:
    """Steady friction at speeds of both signs up to the largest, shape (2 points + 1,)."""
    half = np.geomspace(1e-3 * fastest, fastest, points)
    speeds = np.concatenate([-half[::-1], [np.nan], half])
    torques = [
        np.nan if np.isnan(v) else friction_torque(law, _PATH / abs(v), np.sign(v) * _PATH)[-1]
        for v in speeds
    ]
    # the line runs through zero speed as a step
    speeds[points] = 0.0
    return speeds, np.array(torques)


def presliding(report: Report) -> Chart | None:
    """Friction after turning points, measured and by the law; None if the logs contain none.

    All turns are drawn as if the joint continued in the positive direction.
    """
    # six times as far as presliding reaches
    size = 6.0 * presliding_distance(report.laws[1], 0.9)
    found = [(c, window) for c in report.curves for window in turns(c, size)]
    if not found:
        return None
    # the twelve slowest ones: there presliding has the most samples
    found.sort(key=lambda f: abs(np.ptp(f[0].position[f[1]])) / (f[1].stop - f[1].start))
    gone, measured, law = [], [], []
    for c, w in found[:12]:
        sign = np.sign(c.position[w.stop - 1] - c.position[w.start])
        gone.append(np.abs(c.position[w] - c.position[w.start]))
        measured.append(sign * (c.measured - c.after + c.friction)[w])
        law.append(sign * c.friction[w])
    x, y = (_with_gaps(parts) for parts in (gone, law))
    return Chart(
        "Presliding after the slowest reversals",
        f"displacement since the turn, {report.units[1]}",
        f"friction, {report.units[0]}",
        (
            Series("data", np.concatenate(gone), np.concatenate(measured), "measured", "points"),
            Series("law", x, y, "after"),
        ),
    )


def error_charts(report: Report) -> tuple[tuple[Chart, ...], tuple[Chart, ...]]:
    """Error against measured quantities; then charts of other joints, which explain nothing."""
    found = {name for c in report.curves for name in c.quantities}
    left = [n for n, _ in report.unexplained if n in found and n not in VARIABLES]
    first = [n for n in VARIABLES if n in found] + left
    others = sorted(found - set(first))
    return tuple(_against(report, n) for n in first), tuple(_against(report, n) for n in others)


def _against(report: Report, quantity: str) -> Chart:
    curves = [c for c in report.curves if quantity in c.quantities]
    on = np.concatenate([c.in_motion for c in curves])
    x = np.concatenate([c.quantities[quantity] for c in curves])[on]
    series = []
    for name, stage in _stages(report, "friction law"):
        e = np.concatenate([c.measured - getattr(c, stage) for c in curves])[on]
        series.append(cloud(name, x, e, stage, _POINTS // 2))
        series.append(Series(f"{name}, mean", *_running_mean(x, e), stage))
    label = axis(quantity, report.slide)
    return Chart(f"Error against {label.partition(',')[0]}", label, report.units[0], tuple(series))


def small(chart: Chart) -> Chart:
    """The chart with fewer points, for a page with many charts."""
    thinner = ((s, thinned(_POINTS // 10, s.x, s.y)) for s in chart.series)
    return replace(chart, series=tuple(replace(s, x=x, y=y) for s, (x, y) in thinner))


def over_time(name: str, t: Array, y: Array, colour: Colour) -> Series:
    """A line over time, thinned, interrupted where samples were left out."""
    t, y = thinned(_POINTS, t, y)
    y = y.copy()
    if len(t) > 2:
        step = np.diff(t)
        # a gap in the samples is no line
        y[1:][step > 2.5 * np.median(step)] = np.nan
    return Series(name, t, y, colour)


def cloud(name: str, x: Array, y: Array, colour: Colour, most: int = _POINTS) -> Series:
    """Points, at most so many."""
    x, y = thinned(most, x, y)
    return Series(name, x, y, colour, "points")


def thinned(most: int, *columns: Array) -> tuple[Array, ...]:
    """Every k-th sample."""
    step = max(1, -(-len(columns[0]) // most))
    return tuple(c[::step] for c in columns)


def _with_gaps(parts: Sequence[Array]) -> Array:
    gap = np.array([np.nan])
    return np.concatenate([x for part in parts for x in (part, gap)])


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Means over equal numbers of samples."""
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, 41)))
    if len(edges) < 3:
        return np.array([float(x.mean())]), np.array([float(y.mean())])
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(index, minlength=len(edges) - 1), 1)
    mean = np.bincount(index, y, minlength=len(edges) - 1) / count
    return np.array([0.5 * (a + b) for a, b in pairwise(edges)]), mean


def _rms(e: Array) -> float:
    known = e[np.isfinite(e)]
    return root_mean_square(known) if len(known) else 0.0


def turns(c: Curve, size: float) -> list[slice]:
    """Samples from each turning point until the joint has moved by `size`, or turned again."""
    step = np.diff(c.position)
    moving = np.flatnonzero(step != 0.0)
    # a gap in the samples is no turn
    even = np.diff(c.time) < 1.5 * np.median(np.diff(c.time))
    found = []
    for a, b in pairwise(moving):
        if step[a] * step[b] >= 0.0 or not even[a : b + 1].all():
            continue
        end = b + 1
        while end < len(step) and even[end] and step[end] * step[b] > 0.0:
            end += 1
            # a window needs ten samples
            enough = end - b >= 10
            if enough and abs(c.position[end] - c.position[b]) >= size:
                found.append(slice(int(b), int(end) + 1))
                break
    return found
