"""Write a robot's report: a page for the robot, a page per joint, report.json and model.xml.

If controllers are known, each joint gets its own controller file with the effects of the drive.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from frictionjoint.files import read_report
from frictionjoint.model_text import placed, require_compiles
from frictionjoint.report import charts
from frictionjoint.report.html import fill
from frictionjoint.report.page import FILTERS, render
from frictionjoint.report.robot_report import RobotReport
from frictionjoint.report.robot_summary import joint_content, summarise_robot
from frictionjoint.report.write import json_text, made, write_files


def write_robot_report(report: RobotReport, folder: Path, command: str) -> None:
    """Write all files into `folder`, or none.

    Raises:
        FrictionJointError: the folder cannot be written, or the model would not load there.
    """
    pages = page_names(list(report.joints))
    content = report.to_dict() | {"made": made(command, report.seconds)}
    contents = {
        "report.json": json_text(content),
        "report.html": render_robot(report, pages, content),
        "model.xml": placed(report.mjcf, folder),
    } | {
        pages[name]: render(result.report, joint_content(content, name))
        for name, result in report.joints.items()
    }
    for name, result in report.joints.items():
        if result.report.controller is not None:
            contents[_controller_file(pages[name])] = result.report.controller.to_toml()
    if report.excitation:
        contents["next_trajectory.csv"] = report.excitation.csv()
    write_files(folder, contents, {"model.xml": require_compiles})


def controller_file(report: Path, joint: str) -> Path | None:
    """The controller of a joint that a report of it, or of its robot, has next to it."""
    file, content = read_report(report)
    names = list(content.get("joints", {}))
    own = file.with_name(_controller_file(page_names(names)[joint]) if names else "controller.toml")
    return own if own.is_file() else None


def _controller_file(page: str) -> str:
    return Path(page).with_suffix(".controller.toml").name


def render_robot(report: RobotReport, pages: dict[str, str], content: Mapping[str, Any]) -> str:
    """The page as text.

    Args:
        report: for the time series. pages: file name of each joint's own page.
        content: of report.json, the source of all figures and sentences.
    """
    pictures = []
    for name, result in report.joints.items():
        stretch = charts.worst_stretch(result.report)
        drive, _ = charts.drive_charts(result.report, stretch, "", before=False)
        speed = charts.friction_speed(result.report)
        pictures.append((name, charts.small(drive), charts.small(speed)))
    return fill(
        "robot.html.j2",
        FILTERS,
        s=summarise_robot(content),
        pages=pages,
        pictures=pictures,
        made=content.get("made", {}),
    )


def page_names(joints: list[str]) -> dict[str, str]:
    """A file name per joint, of letters, digits, dots and dashes."""
    found: dict[str, str] = {}
    for i, name in enumerate(joints):
        plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
        text = f"joint_{plain}.html"
        found[name] = f"joint_{i}_{plain}.html" if text in found.values() else text
    return found
