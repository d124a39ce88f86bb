"""The command `compare`: laws, parameter sets or reports in one table."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import progress, show_table
from frictionjoint.errors import ParameterError

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.joint_friction import JointFriction


def compare(
    parameters: Annotated[
        list[Path],
        argument(
            "TOML|REPORT",
            "Parameter files, as `identify` writes them, or report.json of `close-loop`.",
        ),
    ],
    out: Annotated[Path | None, option("FILE", "Drawing: .html, .png or .svg.")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Compare laws, parameters or reports in one table.

    Every law is driven along the same three motions: a slow pull from rest, small reversals before
    sliding, and steady sliding over a range of speeds. For reports, verdicts, errors and friction
    numbers are compared as well.

    Examples:

    `frictionjoint compare elbow.toml wrist.toml --json`

    `frictionjoint compare elbow.toml elbow_lugre.toml --out compare.html`

    `frictionjoint compare monday/report.json friday/report.json`
    """
    from frictionjoint.files import joint_friction, read_parameters
    from frictionjoint.report.compare import KINDS, Compared, compared, draw, report_figures, rows
    from frictionjoint.report.joints import read_joints
    from frictionjoint.report.robot_report import SCHEMA as ROBOT
    from frictionjoint.report.write import write_files

    if out is not None and out.suffix.lower() not in KINDS:
        raise ParameterError(f"--out {out}: the name must end in {', '.join(KINDS)}")
    if out is not None:
        require_writable(out, parameters, force)
    with progress() as say:
        read: dict[str, JointFriction] = {}
        reports: dict[str, dict[str, float | str]] = {}
        names = [_name(path) for path in parameters]
        for i, path in enumerate(parameters):
            say(f"simulating {path.name}, {i + 1} of {len(parameters)}")
            name = names[i] if names.count(names[i]) == 1 else str(path)
            if path in parameters[:i]:
                raise ParameterError(f"{path} is given twice: give it once")
            if path.suffix.lower() == ".json" or path.is_dir():
                for own, content in read_joints(path)[1].items():
                    key = f"{name} {own}" if content.get("schema") == ROBOT else name
                    reports[key] = report_figures(content)
                    if "model" in content:
                        read[key] = joint_friction(content["model"])
            else:
                read[name] = read_parameters(path)
        found = [replace(x, figures=reports.get(x.name, {}) | x.figures) for x in compared(read)]
        # friction without a scale in N m has no curves, but it has errors
        found += [Compared(n, (), own) for n, own in reports.items() if n not in read]
        if out is not None:
            say("drawing")
            write_files(out.parent, {out.name: draw(found, out.suffix.lower())})
    if as_json:
        print_json({x.name: x.figures for x in found})
        return
    show_table(["", *(x.name for x in found)], ((name, *cells) for name, cells in rows(found)))
    if out is not None:
        typer.echo(f"Wrote {out}")


def _name(path: Path) -> str:
    """Of a report its folder's name, of parameters their file's."""
    if path.is_dir():
        return path.resolve().name
    return path.resolve().parent.name if path.suffix.lower() == ".json" else path.stem
