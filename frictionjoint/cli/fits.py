"""Commands that fit: `close-loop`, for one joint, a robot or several of one kind; `identify`."""

import shlex
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from frictionjoint.cli.logs import (
    LAW_TO_FIT,
    LOG_FORMATS,
    NO_OPTIONS,
    Joints,
    LogOptions,
    Logs,
    Model,
    columns_of,
    joints_of,
    log_paths,
    models_of,
    named,
    paths_of,
    reads_logs,
    the_joint,
)
from frictionjoint.cli.output import Force, Json, Open, open_page, print_json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import console, progress, show_report, show_table
from frictionjoint.errors import LogError, ModelError
from frictionjoint.law.names import LAWS

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.report.robot_report import UnitsReport


@reads_logs("gain", "signal", "fixed", "controller")
def close_loop(
    model: Model,
    out: Annotated[Path, option("FOLDER", "Folder for the report.")],
    logs: Annotated[list[Path] | None, argument("LOG", f"{LOG_FORMATS} None with --robot.")] = None,
    joint: Joints = None,
    held_out: Annotated[
        list[str] | None,
        option(
            "LOG|FRACTION",
            "A log to hold out, or the fraction of each log to hold out, at its end. "
            "Repeatable. Default: 0.25.",
        ),
    ] = None,
    law: Annotated[str | None, typer.Option(help=f"{LAW_TO_FIT} Default: {LAWS[0]}.")] = None,
    refine: Annotated[
        bool | None,
        typer.Option(
            "--refine/--no-refine",
            help="Finally fit all parameters to the simulated motion, and use them if they predict "
            "left-out logs better. Default: only if the logs have a target and the controller is "
            "known. --refine: also with measured torque, in windows of half a second.",
        ),
    ] = None,
    options: LogOptions = NO_OPTIONS,
    robot: Annotated[
        list[str] | None,
        option(
            "NAME=LOG",
            "A log of one of several robots of one kind, instead of LOG. Repeatable, also for "
            "the same robot.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        option(
            "ADDRESS",
            "Dask scheduler, tcp://HOST:PORT. Its workers analyse the joints of a robot; the "
            "result is the same.",
        ),
    ] = None,
    seed: Annotated[
        int, option("INTEGER", "Seed of the random tests. Equal seeds give equal reports.", min=0)
    ] = 0,
    open_it: Open = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Identify friction from logs and find what the model lacks; errors before and after.

    Writes FOLDER/report.html (for people), report.json (for scripts) and model.xml (to simulate).

    Examples:

    `frictionjoint close-loop a.csv b.csv --held-out c.csv --model arm.xml --joint elbow --out out`

    `frictionjoint close-loop a.csv --held-out 0.3 --column time_s=t --model arm.xml --joint elbow
    --out out --json`

    A whole robot, every joint with a logged drive: `frictionjoint close-loop a.csv b.csv
    --held-out c.csv --model arm.urdf --out out`

    Several robots of one kind: `frictionjoint close-loop --robot left=a.csv --robot right=b.csv
    --model arm.urdf --out out`
    """
    from frictionjoint.report.folder import FILES, write_report, write_units_report
    from frictionjoint.robot.close_loop import Options, close_loop_logs, close_loop_units
    from frictionjoint.robot.logs import RobotLogs

    if not (logs or robot):
        raise LogError("no log: give one or more, or robots with --robot NAME=LOG")
    paths = log_paths(logs or [], held_out or ["0.25"], options.join)
    units = robots_of(robot or [])
    if units and (paths.logs or paths.kept):
        raise LogError("--robot: give every log as NAME=LOG, and a fraction to --held-out")
    names = joint or []
    if not names and len(only := joints_of(model)) == 1:
        names = only
    alone = names[0] if len(names) == 1 and not units else None
    mjcf = models_of(model)
    if not alone and isinstance(mjcf, dict):
        raise ModelError("--model: several joints share one model, give one without a pattern")
    if alone and scheduler:
        raise LogError("--scheduler distributes the joints of a robot: omit it for one joint")
    read, columns = options.reader(paths), columns_of(options.column)
    command = shlex.join(["frictionjoint", *sys.argv[1:]])

    def logs_of(own: list[Path]) -> RobotLogs:
        return RobotLogs.read(own, paths.kept, paths.fraction, mjcf, alone or names, read, columns)

    with progress() as say:
        inputs = [
            *paths.files,
            *options.files,
            *(x for own in units.values() for x in own),
            *paths_of(model),
        ]
        written = FILES[:2] if units else (*FILES, *(["controller.toml"] if options.files else []))
        require_writable(out, inputs, force, written)
        how = Options(seed, say, law, options.poses, options.controller, refine, None, scheduler)
        if units:
            of_kind = close_loop_units({n: logs_of(x) for n, x in units.items()}, mjcf, how)
            write_units_report(of_kind, out, command)
            content, show = of_kind.to_dict(), partial(show_units, of_kind)
        else:
            report = close_loop_logs(logs_of(paths.logs), mjcf, how)
            say("writing the report")
            write_report(report, out, command)
            content, show = report.to_dict(), partial(show_report, report)
    if as_json:
        print_json(content)
    else:
        show()
        model_file = "" if units else f"   Model: {out / 'model.xml'}"
        typer.echo(f"\nReport: {out / 'report.html'}{model_file}")
    if open_it:
        open_page(out / "report.html")


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
        raise LogError(f"--robot {name}: comparing needs two robots: give the logs of one as LOG")
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


@reads_logs("gain", "signal", "fixed", "controller")
def identify(
    logs: Logs,
    model: Model,
    out: Annotated[Path, option("TOML", "Parameter file to write.")],
    joint: Annotated[
        str | None,
        option("NAME", "A joint in the model and in the logs. Default: the model's only joint."),
    ] = None,
    law: Annotated[str, typer.Option(help=LAW_TO_FIT)] = LAWS[0],
    options: LogOptions = NO_OPTIONS,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit the friction law of one joint and write its parameters.

    Example: `frictionjoint identify a.csv --model arm.xml --joint elbow --out elbow.toml`

    Another law: `... --law lugre --out lugre.toml`, then `frictionjoint compare *.toml`
    """
    from frictionjoint.identify.run import identify_law
    from frictionjoint.report.numbers import law_numbers
    from frictionjoint.report.write import write_files

    with progress() as say:
        paths = log_paths(logs, [], options.join)
        require_writable(out, [*paths.files, *options.files, *paths_of(model)], force)
        joint = the_joint(joint, model)
        read_one = options.reader(paths)
        read = [read_one(path, joint) for path in paths.logs]
        found = identify_law(
            read, models_of(model), joint, law, options.poses, options.controller, say
        )
        write_files(out.parent, {out.name: found.to_toml()})
    if as_json:
        print_json(found.to_dict())
        return
    rows = (
        (x.meaning, x.name, f"{x.text} (fixed)" if x.status == "fixed" else x.qualified)
        for x in law_numbers(found.estimates)
    )
    show_table(("parameter", "symbol", "value ± standard error"), rows)
    for text in found.notes:
        console().print(f"* {text}", soft_wrap=True, markup=False)
    typer.echo(f"{found.residual} Wrote {out}")
