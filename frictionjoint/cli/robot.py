"""`close-loop` of a whole robot."""

import json
import shlex
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.table import Table

from frictionjoint.cli.logs import Reading, split
from frictionjoint.cli.output import require_writable
from frictionjoint.cli.terminal import console, progress
from frictionjoint.errors import LogError

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from collections.abc import Mapping

    from frictionjoint.identify.held import Pose
    from frictionjoint.robot.logs import RobotLogs
    from frictionjoint.robot.report_data import RobotReport


@dataclass(frozen=True)
class RobotRequest:
    """Which logs of which joints.

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
        """All that is read."""
        return [*self.logs, *self.kept, self.model]

    @property
    def kept(self) -> list[Path]:
        """Logs held out."""
        return [path for text in self.held_out if (path := Path(text)).exists()]

    def read(self) -> "RobotLogs":
        """Every joint of every log.

        Raises:
            LogError: see `read_log`, or a joint is named twice.
        """
        from frictionjoint.model_files import compile_model
        from frictionjoint.robot.logs import RobotLogs, joints_to_explain

        names = self.joints
        if len(set(names)) < len(names):
            raise LogError("--joint: a joint is named twice, name it once")
        if not names:
            model = compile_model(self.model)
            names = joints_to_explain([*self.logs, *self.kept], model, self.reading.columns)
        return RobotLogs.read(
            names, lambda n: split(self.logs, self.held_out, replace(self.reading, joint=n))
        )


def close_loop_of_robot(
    request: RobotRequest,
    out: Path,
    force: bool,
    seed: int,
    law: str | None,
    fixed: "Mapping[str, Pose]",
    as_json: bool,
    scheduler: str | None = None,
) -> None:
    """Read, explain, write, show."""
    from frictionjoint.report.write import FILES
    from frictionjoint.report.write_robot import write_robot_report
    from frictionjoint.robot.close_loop import close_loop_robot

    with progress() as say:
        require_writable(out, request.files, force, FILES)
        logs = request.read()
        report = close_loop_robot(logs, request.model, seed, say, law, fixed, scheduler=scheduler)
        say("writing the report")
        write_robot_report(report, out, shlex.join(["frictionjoint", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
        return
    show_robot(report)
    typer.echo(f"Report: {out / 'report.html'}   Model: {out / 'model.xml'}")


def show_robot(report: "RobotReport") -> None:
    """Shared causes, a row a joint, the robot as a whole."""
    from frictionjoint.report.robot_wording import joint_rows, shared_rows, whole

    out = console()
    for row in shared_rows(report):
        out.print(f"shared: {row.cause}{row.place}: {row.values}", soft_wrap=True, markup=False)
        ties = f", or {', '.join(row.ties)}" if row.ties else ""
        out.print(f"  cross-validated gain {row.gain:.1%}, p {row.p_value:.2g}{ties}", markup=False)
    table = Table("joint", "effects added", "torque before", "after", "replay before", "after", "")
    for line in joint_rows(report):
        cells = (line.before, line.after, line.replay_before, line.replay_after)
        table.add_row(line.joint, line.effects, *cells, line.verdict)
    out.print(table)
    proposals = [report.excitation.text] if report.excitation else []
    for text in (whole(report), *report.notes, *proposals):
        out.print(f"* {text}", soft_wrap=True, markup=False)
