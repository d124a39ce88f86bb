"""Commands on reports and parameter files: `compare`, `drift` and `sample`."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from frictionjoint.cli.logs import NO_OPTIONS, LogOptions, Logs, log_paths, reads_logs
from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import progress, show_table
from frictionjoint.errors import ParameterError

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.joint_friction import JointFriction

ReportJoint = Annotated[str | None, option("NAME", "Joint, if the report is of a robot.")]


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


@reads_logs("gain", "fixed", "controller")
def drift(
    report: Annotated[Path, argument("REPORT", "Folder of a report of close-loop.")],
    logs: Logs,
    joint: ReportJoint = None,
    options: LogOptions = NO_OPTIONS,
    as_json: Json = False,
) -> None:
    """State which friction numbers of a report are confirmed by new logs and which have changed.

    *Changed*: the difference exceeds 5% and what the errors of report and logs explain; the exit
    code is then 1. *Not resolvable* (–): the new logs would not show a change by half of the
    number, or the report assumes it. Logs of target and position need the controller next to the
    report, or --controller.

    Example: `frictionjoint drift report today.csv`
    """
    from frictionjoint.control.controller_file import controller_of
    from frictionjoint.control.reconstruct import with_known_drive
    from frictionjoint.model_files import compile_model
    from frictionjoint.recordings.drift import drift as compared
    from frictionjoint.recordings.drift import known_of
    from frictionjoint.report.folder import controller_file

    with progress() as say:
        paths = log_paths(logs, [], options.join)
        known = replace(known_of(report, joint), fixed=options.poses)
        read = options.reader(paths)
        say("comparing")
        given = options.controller or controller_file(report, known.joint)
        drives = controller_of(given, known.joint, [compile_model(known.model)])
        new = [with_known_drive(read(path, known.joint), drives) for path in paths.logs]
        rows = compared(known, new)
    changed = [x.number for x in rows if x.state == "changed"]
    if as_json:
        numbers = [asdict(x) for x in rows]
        print_json({"joint": known.joint, "drift": bool(changed), "numbers": numbers})
    else:
        cells = (
            (
                f"{n.words}, {x.number}",
                f"{x.before:.4g}",
                "–" if x.now is None else f"{x.now:.4g}",
                "–" if x.stderr is None else f"{x.stderr:.2g}",
                x.state,
            )
            for n, x in zip(known.numbers, rows, strict=True)
        )
        show_table(("number", "report", "new logs", "standard error", "result"), cells)
    if changed:
        raise typer.Exit(1)


def sample(
    report: Annotated[Path, argument("REPORT", "report.json of close-loop, or its folder.")],
    n: Annotated[int, typer.Option(min=1, max=100_000, help="Number of samples.")],
    out: Annotated[Path, option("JSON", "File to write.")],
    joint: ReportJoint = None,
    seed: Annotated[int, typer.Option(min=0, help="Equal seeds give equal samples.")] = 0,
    force: Force = False,
) -> None:
    """Draw parameter sets of a report, for domain randomisation.

    Writes a JSON list of tables with the keys of a parameter file. In Python,
    `frictionjoint.files.joint_friction(table)` makes the friction that `fj.install` adds.

    Examples:

    `frictionjoint sample out --n 1024 --out samples.json`

    `frictionjoint sample robot_report --joint elbow --n 1024 --out elbow.json`
    """
    from frictionjoint.files import toml_document
    from frictionjoint.refine.posterior import Posterior
    from frictionjoint.report.joints import read_joint
    from frictionjoint.report.write import write_files

    if out.suffix.lower() != ".json":
        raise ParameterError(f"--out {out}: the name must end in .json")
    file, _, own = read_joint(report, joint)
    require_writable(out, [file], force)
    if "posterior" not in own:
        fix = "make the report from logs that determine the torque scale"
        raise ParameterError(f"{file}: it contains no parameter uncertainty: {fix}")
    try:
        drawn = Posterior.from_dict(own["posterior"]).sample(n, seed)
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}") from None
    tables = [toml_document(x.parameters, x.effects).unwrap() for x in drawn]
    write_files(out.parent, {out.name: json.dumps(tables, indent=1) + "\n"})
    typer.echo(f"Wrote {n} parameter sets to {out}")
