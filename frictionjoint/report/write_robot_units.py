"""Write the reports of several robots of one kind: a page over all, a folder for each unit."""

import json
import shutil
from pathlib import Path

from frictionjoint.report.html import fill
from frictionjoint.report.robot_wording import whole
from frictionjoint.report.write import write_files
from frictionjoint.report.write_robot import write_robot_report
from frictionjoint.robot.units import UnitsReport

FILES = ("report.json", "report.html")


def write_units_report(report: UnitsReport, folder: Path, command: str) -> None:
    """Write report.json and report.html into `folder`, and each unit's report into a folder there.

    A folder that did not exist is left whole or absent.

    Raises:
        FrictionJointError: the folder cannot be written, or a model would not load there.
    """
    new = not folder.exists()
    try:
        write_files(
            folder,
            {
                "report.json": json.dumps(report.to_dict(), indent=2, allow_nan=False) + "\n",
                "report.html": render_units(report, command),
            },
        )
        for name, unit in report.units.items():
            write_robot_report(unit, folder / name, command)
    except BaseException:
        if new:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def render_units(report: UnitsReport, command: str) -> str:
    """The page as text."""
    return fill(
        "robot_units.html.j2",
        {},
        report=report,
        sentences={name: whole(unit) for name, unit in report.units.items()},
        spreads=report.spreads,
        command=command,
    )
