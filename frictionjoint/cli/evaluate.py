"""The command `evaluate`: the error of a model on logs."""

import json
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import NO_OPTIONS, Joints, LogOptions, Logs, log_paths, reads_logs
from frictionjoint.cli.output import Force, Json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import console, progress, show_table

FILES = ("evaluation.html", "evaluation.json")


@reads_logs("gain", "fixed", "controller")
def evaluate(
    model: Annotated[Path, argument("MODEL", "MJCF or URDF, with any friction or none.")],
    logs: Logs,
    joint: Joints = None,
    out: Annotated[Path | None, option("FOLDER", "Folder for a page with plots.")] = None,
    options: LogOptions = NO_OPTIONS,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """State the error of a model on logs; nothing is fitted.

    The model may contain friction of this package, MuJoCo's own friction, or none.

    Examples:

    `frictionjoint evaluate arm.xml a.csv b.csv --joint elbow`

    `frictionjoint evaluate arm_friction.xml logs --controller elbow.toml --out evaluation --json`
    """
    from frictionjoint.evaluation.page import figures, page
    from frictionjoint.evaluation.run import evaluate as run
    from frictionjoint.report.write import write_files

    with progress() as say:
        paths = log_paths(logs, [], options.join)
        if out is not None:
            require_writable(out, [*paths.files, *options.files, model], force, FILES)
        read = options.reader(paths)
        say("evaluating")
        found = run(model, paths.logs, joint, options.controller, options.poses, read)
        text = json.dumps(found.to_dict(), indent=2)
        if out is not None:
            say("writing the page")
            write_files(out, dict(zip(FILES, (page(found), text + "\n"), strict=True)))
    if as_json:
        typer.echo(text)
        return
    rows = (
        (
            *(name, x.friction, figures(x.torque_rms, x.unit), figures(x.torque_percent, "%")),
            *(figures(error, x.position_unit) for error in (x.replay_rms, x.closed_loop_mae)),
        )
        for name, x in found.joints.items()
    )
    head = "joint", "friction", "torque error", "of the torque", "position error", "in closed loop"
    show_table(head, rows)
    for note in found.notes:
        console().print(f"* {note}", soft_wrap=True, markup=False)
    if out is not None:
        typer.echo(f"Page: {out / FILES[0]}")
