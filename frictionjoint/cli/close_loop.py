"""The command `close-loop`, for one joint, a robot, or several robots of one kind."""

import json
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import (
    LAW_TO_FIT,
    LOG_FORMATS,
    NO_OPTIONS,
    ControllerFile,
    Fixed,
    LogOptions,
    Model,
    joints_of,
    log_paths,
    models_of,
    paths_of,
    poses,
    reads_logs,
    split,
)
from frictionjoint.cli.output import Force, Json, Open, open_page, require_writable
from frictionjoint.cli.robot import (
    RobotRequest,
    close_loop_of_robot,
    close_loop_of_units,
    robots_of,
)
from frictionjoint.cli.terminal import progress, show_report
from frictionjoint.errors import LogError, ModelError
from frictionjoint.law.names import LAWS

Logs = Annotated[
    list[Path] | None, typer.Argument(metavar="LOG", help=f"{LOG_FORMATS} None with --robot.")
]
Joints = Annotated[
    list[str] | None,
    typer.Option(
        "--joint",
        metavar="NAME",
        help="A joint in the model and in the logs. Repeatable. Default: all joints whose drive "
        "the logs contain.",
    ),
]
Law = Annotated[str | None, typer.Option("--law", help=f"{LAW_TO_FIT} Default: {LAWS[0]}.")]
Seed = Annotated[
    int,
    typer.Option(
        min=0, metavar="INTEGER", help="Seed of the random tests. Equal seeds give equal reports."
    ),
]


@reads_logs("gain", "signal")
def close_loop_command(
    model: Model,
    out: Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Folder for the report.")],
    logs: Logs = None,
    joint: Joints = None,
    held_out: Annotated[
        list[str] | None,
        typer.Option(
            "--held-out",
            metavar="LOG|FRACTION",
            help="A log to hold out, or the fraction of each log to hold out, at its end. "
            "Repeatable. Default: 0.25.",
        ),
    ] = None,
    law: Law = None,
    fixed: Fixed = None,
    controller: ControllerFile = None,
    refine: Annotated[
        bool | None,
        typer.Option(
            "--refine/--no-refine",
            help="Finally fit all numbers to the simulated motion, and use them if they predict "
            "logs left out of this fit better. Default: only if the logs have a target and the "
            "controller is known. --refine: also in other cases, in windows of half a second "
            "driven by the measured torque.",
        ),
    ] = None,
    options: LogOptions = NO_OPTIONS,
    robot: Annotated[
        list[str] | None,
        typer.Option(
            "--robot",
            metavar="NAME=LOG",
            help="A log of one of several robots of one kind, instead of LOG. Repeatable, also for "
            "the same robot.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Dask scheduler, tcp://HOST:PORT. Its workers analyse the joints of a robot; the "
            "result is the same.",
        ),
    ] = None,
    seed: Seed = 0,
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
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import FILES, write_report

    if not (logs or robot):
        raise LogError("no log: give one or more, or robots with --robot NAME=LOG")
    paths = log_paths(logs or [], held_out or ["0.25"], options.join)
    logs, held_out = paths.logs, paths.held_out
    if not (robot or joint) and len(only := joints_of(model)) == 1:
        joint = only
    if robot or joint is None or len(joint) != 1:
        reading = options.reading("", paths)
        mjcf = models_of(model)
        if isinstance(mjcf, dict):
            raise ModelError("--model: several joints share one model, give one without a pattern")
        request = RobotRequest(logs, held_out, Path(mjcf), joint or [], reading)
        search = {"seed": seed, "law": law, "fixed": poses(fixed), "scheduler": scheduler}
        search |= {"controller": controller, "refine": refine}
        if robot:
            close_loop_of_units(request, robots_of(robot), out, force, as_json, search)
        else:
            close_loop_of_robot(request, out, force, as_json, search)
        if open_it:
            open_page(out / "report.html")
        return
    if scheduler:
        raise LogError("--scheduler distributes the joints of a robot: omit it for one joint")
    with progress() as say:
        read = [*logs, *(Path(text) for text in held_out), *paths_of(model)]
        require_writable(out, read, force, FILES)
        reading = options.reading(joint[0], paths)
        fitted, kept = split(logs, held_out, reading)
        report = close_loop(
            fitted,
            models_of(model),
            joint[0],
            kept,
            seed,
            say,
            law,
            poses(fixed),
            controller,
            refine,
        )
        say("writing the report")
        write_report(report, out, shlex.join(["frictionjoint", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
    else:
        show_report(report)
        typer.echo(f"\nReport: {out / 'report.html'}   Model: {out / 'model.xml'}")
    if open_it:
        open_page(out / "report.html")
