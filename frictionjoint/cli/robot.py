"""`close-loop` of several robots of one kind."""

from pathlib import Path
from typing import TYPE_CHECKING

from frictionjoint.cli.logs import named
from frictionjoint.cli.terminal import console, show_table
from frictionjoint.errors import LogError

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.report.units_report import UnitsReport


def robots_of(robots: list[str]) -> dict[str, list[Path]]:
    """Logs by the robot's name, from texts NAME=LOG; FrictionJointError if a text does not have
    that form, a name cannot name a folder, a log is given twice, or there is only one robot."""
    found: dict[str, list[Path]] = {}
    for text in robots:
        name, path = named("--robot", text, "write NAME=LOG, e.g. left=left_arm.csv")
        if "/" in name or name.startswith("."):
            raise LogError(f"--robot {name}: give a name for a folder, without / and leading .")
        if any(Path(path) in logs for logs in found.values()):
            raise LogError(f"--robot {text}: this log is given twice, give each robot its own")
        found.setdefault(name, []).append(Path(path))
    if len(found) == 1:
        raise LogError(f"--robot {name}: one robot is compared with none: give its logs as LOG")
    return found


def show_units(report: "UnitsReport") -> None:
    """Each unit in a sentence, and their variation."""
    from frictionjoint.report.page import unit_sentence

    out = console()
    for name, unit in report.units.items():
        out.print(f"{name}: {unit_sentence(unit.to_dict())}", soft_wrap=True, markup=False)
    for name, text in report.failed.items():
        out.print(f"{name}: {text}", soft_wrap=True, markup=False)
    rows = []
    for label, row in report.rows:
        error = "-" if row.error is None else f"{row.error:.2g}"
        rows.append((row.owner, label, f"{row.mean:.4g}", f"{row.deviation:.2g}", error))
    heads = "joint or cause", "parameter", "mean", "deviation over robots", "standard error of one"
    show_table(heads, rows)
