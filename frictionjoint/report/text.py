"""A report as plain text, for the terminal and `Report.summary`."""

from collections.abc import Collection, Mapping
from typing import Any

from frictionjoint.report.robot_summary import RobotSummary
from frictionjoint.report.summary import Summary

# notes that a terminal has room for; the page has all of them
_MOST_NOTES = 5


def summary_text(content: Mapping[str, Any]) -> str:
    """The verdict, the friction numbers, the effects or causes, and the most important notes in
    report.json of one joint or of a robot."""
    if "joints" in content:
        return _robot_text(RobotSummary(content))
    s = Summary(content)
    lines = _labelled(s.verdict_lines)
    lines += ["", f"Friction of {s.joint or 'the joint'}, law {s.laws[1]}:"]
    lines += _labelled([(x.meaning, x.qualified) for x in s.friction], indent="  ")
    for x in s.effects:
        lines.append(f"  {x.title}: {'; '.join(x.size) or 'in the model'}")
    lines += _notes(s)
    shown = [f"{size} ({name})" for name, size in s.smallest if size]
    if shown:
        ends = ", ..., ".join(dict.fromkeys((shown[0], shown[-1])))
        lead = "Smallest detectable further effects, rms"
        lines += ["", f"{lead}: {ends}; all are listed in report.html."]
    return "\n".join(lines)


def _robot_text(s: RobotSummary) -> str:
    lines = _labelled(s.verdict_lines)
    for cause in s.shared:
        lines.append(f"  {cause.title}: {', '.join(cause.size)}")
    for row in s.rows:
        lines += ["", f"{row.joint}: {row.verdict}; missing: {row.effects}"]
        lines.append(f"  error: torque {row.torque}, position {row.position}")
        numbers = zip(s.friction_head, row.friction, strict=True)
        lines.append("  " + ", ".join(f"{name} {x}" for name, x in numbers))
    lines += [f"{name}: no result: {why}" for name, why in s.failed.items()]
    for t in s.torsion:
        gear = [f"{key} {t[key]}" for key in ("stiffness", "backlash", "hysteresis")]
        if not all(text.endswith("none seen") for text in gear):
            lines.append(f"{t['joint']}: gear {', '.join(gear)}")
    return "\n".join([*lines, *_notes(s)])


def _notes(s: Summary | RobotSummary) -> list[str]:
    lines = ["", *(f"* {note}" for note in s.notes[:_MOST_NOTES])] if s.notes else []
    if len(s.notes) > _MOST_NOTES:
        lines.append(f"* More notes in report.html: {len(s.notes) - _MOST_NOTES}.")
    return lines


def _labelled(rows: Collection[tuple[str, str]], indent: str = "") -> list[str]:
    width = max((len(label) for label, _ in rows), default=0)
    return [f"{indent}{label + ':':<{width + 1}} {text}" for label, text in rows]
