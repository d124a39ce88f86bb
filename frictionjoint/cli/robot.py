"""`close-loop` of a whole robot."""

import json
import shlex
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.table import Table

from frictionjoint.cli.logs import Reading, kept_of
from frictionjoint.cli.output import require_writable
from frictionjoint.cli.terminal import console, progress, show_report
from frictionjoint.errors import LogError

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.report.units_report import UnitsReport
    from frictionjoint.robot.logs import RobotLogs


@dataclass(frozen=True)
class RobotRequest:
    """Logs of the joints of a robot.

    Attributes:
        held_out: logs, or a fraction. joints: names, none for all. reading: of any joint.
    """

    logs: list[Path]
    held_out: list[str]
    model: Path
    joints: list[str]
    reading: Reading

    @property
    def files(self) -> list[Path]:
        """All files that are read."""
        return [*self.logs, *self.kept, self.model]

    @property
    def kept(self) -> list[Path]:
        """Held-out logs."""
        return kept_of([], self.held_out)[0]

    def of_unit(self, logs: list[Path]) -> "RobotRequest":
        """The request for one of several robots."""
        return replace(self, logs=logs)

    def read(self) -> "RobotLogs":
        """Every joint of every log.

        Raises:
            LogError: see `read_log`, or a joint is named twice.
        """
        from frictionjoint.identify.driven_joints import joints_to_explain
        from frictionjoint.model_files import compile_model
        from frictionjoint.robot.logs import RobotLogs

        names = self.joints
        if len(set(names)) < len(names):
            raise LogError("--joint: a joint is named twice, name it once")
        if not names:
            model = compile_model(self.model)
            names = joints_to_explain([*self.logs, *self.kept], model, self.reading.columns)
        kept, fraction = kept_of(self.logs, self.held_out)
        return RobotLogs.read(
            *(names, self.logs, kept, fraction),
            lambda path, joint: replace(self.reading, joint=joint).read(path),
        )


def close_loop_of_robot(
    request: RobotRequest, out: Path, force: bool, as_json: bool, search: dict[str, Any]
) -> None:
    """Read, analyse, write and show.

    Args:
        out: folder of the report. search: further arguments of `close_loop_robot`.
    """
    from frictionjoint.report.write import FILES
    from frictionjoint.report.write_robot import write_robot_report
    from frictionjoint.robot.close_loop import close_loop_robot

    with progress() as say:
        require_writable(out, request.files, force, FILES)
        logs = request.read()
        report = close_loop_robot(logs, request.model, progress=say, **search)
        say("writing the report")
        write_robot_report(report, out, shlex.join(["frictionjoint", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
        return
    show_report(report)
    typer.echo(f"Report: {out / 'report.html'}   Model: {out / 'model.xml'}")


def robots_of(robots: list[str]) -> dict[str, list[Path]]:
    """Logs by the robot's name, from texts NAME=LOG.

    Raises:
        LogError: a text does not have that form, or a name cannot name a folder.
    """
    found: dict[str, list[Path]] = {}
    for text in robots:
        name, equals, path = text.partition("=")
        if not (name and equals and path):
            raise LogError(f"--robot {text}: write NAME=LOG, e.g. left=left_arm.csv")
        if "/" in name or name.startswith("."):
            raise LogError(f"--robot {name}: give a name for a folder, without / and leading .")
        found.setdefault(name, []).append(Path(path))
    return found


def close_loop_of_units(
    request: RobotRequest,
    units: dict[str, list[Path]],
    out: Path,
    force: bool,
    as_json: bool,
    search: dict[str, Any],
) -> None:
    """Read, analyse, write and show several robots of one kind."""
    from frictionjoint.report.write_robot_units import FILES, write_units_report
    from frictionjoint.robot.units import close_loop_units

    if request.logs or request.kept:
        raise LogError("--robot: give every log as NAME=LOG, and a fraction to --held-out")
    with progress() as say:
        read = [path for paths in units.values() for path in paths]
        require_writable(out, [*read, request.model], force, FILES)
        logs = {name: request.of_unit(paths).read() for name, paths in units.items()}
        report = close_loop_units(logs, request.model, progress=say, **search)
        say("writing the reports")
        write_units_report(report, out, shlex.join(["frictionjoint", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
        return
    show_units(report)
    typer.echo(f"Report: {out / 'report.html'}")


def show_units(report: "UnitsReport") -> None:
    """Each unit in a sentence, and their variation."""
    from frictionjoint.report.write_robot_units import unit_sentence

    out = console()
    for name, unit in report.units.items():
        out.print(f"{name}: {unit_sentence(unit.to_dict())}", soft_wrap=True, markup=False)
    for name, text in report.failed.items():
        out.print(f"{name}: {text}", soft_wrap=True, markup=False)
    table = Table("of", "parameter", "mean", "deviation", "standard error")
    for row in report.spreads:
        error = "-" if row.error is None else f"{row.error:.2g}"
        measured_in = "" if row.unit == "1" else f", {row.unit}"
        cells = f"{row.mean:.4g}", f"{row.deviation:.2g}", error
        table.add_row(row.owner, row.name + measured_in, *cells)
    out.print(table)
