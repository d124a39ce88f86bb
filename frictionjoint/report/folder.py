"""The folder of a report: pages, report.json and model.xml, controllers and the next motion."""

import json
import shutil
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from frictionjoint.model_text import placed, require_compiles
from frictionjoint.report.html import versions
from frictionjoint.report.joint_report import Report
from frictionjoint.report.joints import joint_content, read_joints
from frictionjoint.report.page import page_names, render, render_robot, render_units
from frictionjoint.report.robot_report import SCHEMA as ROBOT
from frictionjoint.report.robot_report import RobotReport, UnitsReport
from frictionjoint.report.write import write_files

FILES = ("report.json", "report.html", "model.xml")


def write_report(report: Report | RobotReport, folder: Path, command: str) -> None:
    """Write report.json, report.html and model.xml into `folder`, or nothing.

    A robot gets a page per joint, and next_trajectory.csv. Known controllers are written with the
    effects of the drive: controller.toml, or one per joint.

    Raises:
        FrictionJointError: the folder cannot be written, or the model would not load there.
    """
    content = report.to_dict() | {"made": made(command, report.seconds)}
    contents = {"report.json": _json_text(content), "model.xml": placed(report.mjcf, folder)}
    if isinstance(report, RobotReport):
        joints, pages = report.joints, page_names(list(report.joints))
        contents["report.html"] = render_robot(report, content)
        if report.excitation:
            contents["next_trajectory.csv"] = report.excitation.csv()
    else:
        joints, pages = {report.joint: report}, {report.joint: "report.html"}
    for name, joint in joints.items():
        contents[pages[name]] = render(joint, joint_content(content, name))
        if joint.controller is not None:
            contents[_controller_name(pages[name])] = joint.controller.to_toml()
    write_files(folder, contents, {"model.xml": require_compiles})


def write_units_report(report: UnitsReport, folder: Path, command: str) -> None:
    """Write report.json and report.html into a folder, and those of each unit below it, or nothing.

    Raises:
        FrictionJointError: the folder cannot be written, or a model would not load there.
    """
    new = not folder.exists()
    content = report.to_dict() | {"made": made(command)}
    texts = _json_text(content), render_units(report, content)
    try:
        write_files(folder, dict(zip(FILES, texts, strict=False)))
        for name, unit in report.units.items():
            write_report(unit, folder / name, command)
    except BaseException:
        if new:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def controller_file(report: Path, joint: str) -> Path | None:
    """The controller of a joint that a report of it, or of its robot, has next to it."""
    file, joints = read_joints(report)
    whole = joints[joint].get("schema") == ROBOT
    page = page_names(list(joints))[joint] if whole else "report.html"
    own = file.with_name(_controller_name(page))
    return own if own.is_file() else None


def _controller_name(page: str) -> str:
    own = Path(page).with_suffix(".controller.toml").name
    return "controller.toml" if page == "report.html" else own


def made(command: str, seconds: float | None = None) -> dict[str, Any]:
    """How a report was made, as in report.json: command, date, versions, duration in s."""
    found = {
        "command": command,
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "versions": versions(),
    }
    return found if seconds is None else found | {"seconds": seconds}


def _json_text(content: Mapping[str, Any]) -> str:
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
