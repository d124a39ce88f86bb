"""Pages of a report: of one joint, of a robot, of several robots. Each is self-contained."""

import re
from collections.abc import Mapping
from typing import Any

from frictionjoint.report import charts, wording
from frictionjoint.report.html import fill
from frictionjoint.report.joint_report import Report
from frictionjoint.report.robot_report import RobotReport, UnitsReport
from frictionjoint.report.robot_summary import RobotSummary
from frictionjoint.report.summary import Summary
from frictionjoint.report.wording import quantity

FILTERS = {
    "figures": wording.three,
    "known_as": wording.known_as,
    "quantity": quantity,
    "interval": wording.interval,
}


def render(report: Report, content: Mapping[str, Any]) -> str:
    """The page of one joint as text: all figures and sentences from report.json, time series from
    the report."""
    s = Summary(content)
    curve, window = charts.worst_stretch(report)
    position = charts.worst_position(report)
    # the curves before are those of the errors before, unless causes are shared with other joints
    before = s.changed and all(row["before"] is not None for row in s.logs)
    in_detail = [*charts.drive_charts(report, curve, window, "stretch", before)]
    in_whole = [*charts.drive_charts(report, curve, slice(None), "whole", before)]
    if position:
        shown, group, times = position, "position", charts.worst_times(position)
        if not s.position_first:
            at = curve.name, curve.role
            same = [x for x in report.positions if (x.name, x.role) == at]
            times = charts.ends_of(curve.time[window])
            shown, group = [*same, position][0], "stretch"
        place = 0 if s.position_first else len(in_detail)
        in_detail[place:place] = charts.position_charts(report, shown, times, group)
        in_whole[place:place] = charts.position_charts(report, shown, None, "whole-position")
    first, others = charts.error_charts(report)
    stiffness = [x.status for x in s.friction if x.name == "stiffness"]
    return fill(
        "page.html.j2",
        FILTERS,
        s=s,
        where="held out" if curve.role == "held-out" else "fitted",
        log=curve.name,
        position_log=position.name if position and s.position_first else "",
        friction_speed=charts.friction_speed(report),
        presliding=charts.presliding(report) if "determined" in stiffness else None,
        in_detail=in_detail,
        in_whole=in_whole,
        steps=[step[:8] for step in s.steps],
        widest=max([0.1, *(c.gain for step in s.steps for c in step)]),
        error_charts=first,
        other_charts=others,
        bandwidth=content.get("bandwidth_hz"),
        closed_loop=any(e.quantity.endswith("closed loop") for e in s.errors),
        made=content.get("made", {}),
    )


def render_robot(report: RobotReport, content: Mapping[str, Any]) -> str:
    """The page of a robot as text; arguments as those of `render`."""
    pictures = []
    for name, joint in report.joints.items():
        drive, _ = charts.drive_charts(joint, *charts.worst_stretch(joint), "", before=False)
        speed = charts.friction_speed(joint)
        pictures.append((name, charts.small(drive), charts.small(speed)))
    return fill(
        "robot.html.j2",
        FILTERS,
        s=RobotSummary(content),
        pages=page_names(list(report.joints)),
        pictures=pictures,
        made=content.get("made", {}),
    )


def render_units(report: UnitsReport, content: Mapping[str, Any]) -> str:
    """The page of several robots of one kind as text, from the content of report.json."""
    return fill(
        "robot_units.html.j2",
        {},
        report=report,
        sentences={name: unit_sentence(x) for name, x in content["units"].items()},
        rows=report.rows,
        made=content.get("made", {}),
    )


def unit_sentence(content: Mapping[str, Any]) -> str:
    """A unit's verdict and errors in two sentences."""
    missing, error = RobotSummary(content).verdict_lines[:2]
    return f"{': '.join(missing)} {': '.join(error)}"


def page_names(joints: list[str]) -> dict[str, str]:
    """A file name per joint of a robot, of letters, digits, dots and dashes."""
    found: dict[str, str] = {}
    for i, name in enumerate(joints):
        plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
        text = f"joint_{plain}.html"
        found[name] = f"joint_{i}_{plain}.html" if text in found.values() else text
    return found
