"""Write a robot's report: one page for all, one a joint behind it, report.json and model.xml.

Where controllers are known, each joint has its own: what was found of its drive is in it.
"""

import json
import re
from pathlib import Path

from frictionjoint.model_text import placed, require_compiles
from frictionjoint.report.html import fill
from frictionjoint.report.page import render
from frictionjoint.report.robot_wording import (
    joint_rows,
    shared_rows,
    torsion_rows,
    unstated,
    whole,
)
from frictionjoint.report.wording import three
from frictionjoint.report.write import write_files
from frictionjoint.robot.report_data import RobotReport


def write_robot_report(report: RobotReport, folder: Path, command: str) -> None:
    """Write all files into `folder`, or none.

    Raises:
        FrictionJointError: the folder cannot be written, or the model would not load there.
    """
    pages = page_names(list(report.joints))
    contents = {
        "report.json": json.dumps(report.to_dict(), indent=2, allow_nan=False) + "\n",
        "report.html": render_robot(report, pages, command),
        "model.xml": placed(report.mjcf, folder),
    } | {pages[name]: render(r.report, command) for name, r in report.joints.items()}
    for name, result in report.joints.items():
        if result.report.controller is not None:
            file = Path(pages[name]).with_suffix(".controller.toml").name
            contents[file] = result.report.controller.to_toml()
    if report.excitation:
        contents["next_trajectory.csv"] = report.excitation.csv()
    write_files(folder, contents, {"model.xml": require_compiles})


def render_robot(report: RobotReport, pages: dict[str, str], command: str) -> str:
    """The page as text; `pages`: names of the joints' own."""
    joints = joint_rows(report)
    return fill(
        "robot.html.j2",
        {"figures": three},
        report=report,
        sentence=whole(report),
        shared=shared_rows(report),
        joints=joints,
        unstated=unstated(joints),
        twists=torsion_rows(report),
        pages=pages,
        command=command,
    )


def page_names(joints: list[str]) -> dict[str, str]:
    """A file name for each joint, of letters, digits, points and dashes."""
    found: dict[str, str] = {}
    for i, name in enumerate(joints):
        plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
        text = f"joint_{plain}.html"
        found[name] = f"joint_{i}_{plain}.html" if text in found.values() else text
    return found
