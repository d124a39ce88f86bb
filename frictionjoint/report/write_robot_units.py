"""Write the reports of several robots of one kind: a page over all, a folder per unit."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from frictionjoint.report.html import fill
from frictionjoint.report.robot_summary import summarise_robot
from frictionjoint.report.units_report import UnitsReport
from frictionjoint.report.write import json_text, made, write_files
from frictionjoint.report.write_robot import write_robot_report

FILES = ("report.json", "report.html")


def write_units_report(report: UnitsReport, folder: Path, command: str) -> None:
    """Write report.json and report.html into `folder`, and each unit's report into a subfolder.

    A new folder is written as a whole or not at all.

    Raises:
        FrictionJointError: the folder cannot be written, or a model would not load there.
    """
    new = not folder.exists()
    content = report.to_dict() | {"made": made(command)}
    try:
        write_files(
            folder,
            {"report.json": json_text(content), "report.html": render_units(report, content)},
        )
        for name, unit in report.units.items():
            write_robot_report(unit, folder / name, command)
    except BaseException:
        if new:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def render_units(report: UnitsReport, content: Mapping[str, Any]) -> str:
    """The page as text, from the content of report.json."""
    return fill(
        "robot_units.html.j2",
        {},
        report=report,
        sentences={name: unit_sentence(x) for name, x in content["units"].items()},
        spreads=report.spreads,
        made=content.get("made", {}),
    )


def unit_sentence(content: Mapping[str, Any]) -> str:
    """A unit's verdict and errors in two sentences."""
    missing, error = summarise_robot(content).verdict_lines[:2]
    return f"{': '.join(missing)} {': '.join(error)}"
