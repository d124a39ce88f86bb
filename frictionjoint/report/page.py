"""report.html of one joint: a self-contained page."""

from collections.abc import Mapping
from typing import Any

from frictionjoint.report import charts, wording
from frictionjoint.report.html import fill
from frictionjoint.report.joint_report import Report
from frictionjoint.report.numbers import status_of
from frictionjoint.report.summary import Summary, summarise
from frictionjoint.report.wording import quantity

FILTERS = {
    "figures": wording.three,
    "known_as": wording.known_as,
    "quantity": quantity,
    "interval": wording.interval,
}


def render(report: Report, content: Mapping[str, Any]) -> str:
    """The page as text.

    Args:
        report: for the time series.
        content: of report.json, the source of all figures and sentences.
    """
    s = summarise(content)
    stretch = charts.worst_stretch(report)
    position = charts.worst_position(report)
    # the curves before are those of the errors before, unless causes are shared with other joints
    before = all(row.before is not None for row in s.logs) if s.changed else False
    drive_part: tuple[charts.Chart, ...] = charts.drive_charts(report, stretch, "stretch", before)
    position_part: tuple[charts.Chart, ...] = ()
    position_whole: tuple[charts.Chart, ...] = ()
    if position:
        times = charts.worst_times(position) if s.position_first else stretch.times
        same = next(
            (
                x
                for x in report.positions
                if (x.name, x.role) == (stretch.curve.name, stretch.curve.role)
            ),
            position,
        )
        shown = position if s.position_first else same
        group = "position" if s.position_first else "stretch"
        position_part = charts.position_charts(report, shown, times, group)
        position_whole = charts.position_charts(report, shown, None, "whole-position")
    whole = charts.Stretch(stretch.curve, slice(None))
    drive_whole: tuple[charts.Chart, ...] = charts.drive_charts(report, whole, "whole", before)
    first, others = charts.error_charts(report)
    in_detail, in_whole = (drive_part, position_part), (drive_whole, position_whole)
    if s.position_first:
        in_detail, in_whole = in_detail[::-1], in_whole[::-1]
    return fill(
        "page.html.j2",
        FILTERS,
        s=s,
        where="held out" if stretch.curve.role == "held-out" else "fitted",
        log=stretch.curve.name,
        position_log=position.name if position and s.position_first else "",
        friction_speed=charts.friction_speed(report),
        presliding=charts.presliding(report) if _shows_presliding(report) else None,
        in_detail=[c for part in in_detail for c in part],
        in_whole=[c for part in in_whole for c in part],
        steps=[step[:8] for step in s.steps],
        widest=_widest(s),
        error_charts=first,
        other_charts=others,
        bandwidth=content.get("bandwidth_hz"),
        closed_loop=any(e.quantity.endswith("closed loop") for e in s.errors),
        made=content.get("made", {}),
    )


def _shows_presliding(report: Report) -> bool:
    """Whether the logs determine the presliding stiffness."""
    law = report.final
    return "stiffness" in law and status_of("stiffness", law) == "determined"


def _widest(s: Summary) -> float:
    """The largest gain of a candidate, which scales the bars."""
    return max([0.1, *(c.gain for step in s.steps for c in step)])
