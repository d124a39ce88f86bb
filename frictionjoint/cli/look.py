"""Commands on logs that fit nothing: `plot` and `evaluate`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import NO_OPTIONS, Joints, LogOptions, Logs, log_paths, reads_logs
from frictionjoint.cli.output import Force, Json, Open, open_page, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import console, progress, show_table, warnings_afterwards
from frictionjoint.errors import LogError

_PICTURES = (".html", ".png", ".svg")
_PAGE = ("evaluation.html", "evaluation.json")


@reads_logs()
def plot(
    logs: Logs,
    joint: Annotated[str | None, option("NAME", "Joint, if a log contains several.")] = None,
    out: Annotated[
        Path | None,
        option("FILE", "Page or picture to write: .html, .png or .svg. Default: LOG.html here."),
    ] = None,
    options: LogOptions = NO_OPTIONS,
    open_it: Open = False,
    force: Force = False,
) -> None:
    """Draw logs as measured: position, velocity and drive.

    Look for wrong units, gaps, a saturated drive, and rest, before you fit anything.

    Examples:

    `frictionjoint plot elbow.csv --open`

    `frictionjoint plot arm.csv --joint elbow --column time_s=t --out elbow.html`
    """
    from frictionjoint.plotting import plot_text
    from frictionjoint.report.log_plot import described, unit_doubt
    from frictionjoint.report.write import write_files

    found = log_paths(logs, [], options.join)
    target = out or Path(f"{found.logs[0].stem}.html")
    if target.suffix.lower() not in _PICTURES:
        raise LogError(f"--out {target}: the name must end in {', '.join(_PICTURES)}")
    require_writable(target, found.files, force)
    read_one = options.reader(found)
    with progress() as say, warnings_afterwards():
        read = []
        for i, path in enumerate(found.logs):
            say(f"reading {path.name}, {i + 1} of {len(found.logs)}")
            read.append(read_one(path, joint or ""))
        say("drawing")
        write_files(target.parent, {target.name: plot_text(read, target.suffix.lower())})
    for log in read:
        typer.echo(described(log))
        for note in filter(None, (unit_doubt(log), *log.notes)):
            typer.echo(f"* {note}")
    typer.echo(f"Wrote {target}")
    if open_it:
        open_page(target)


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
            require_writable(out, [*paths.files, *options.files, model], force, _PAGE)
        read = options.reader(paths)
        say("evaluating")
        found = run(model, paths.logs, joint, options.controller, options.poses, read)
        text = json.dumps(found.to_dict(), indent=2)
        if out is not None:
            say("writing the page")
            write_files(out, dict(zip(_PAGE, (page(found), text + "\n"), strict=True)))
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
        typer.echo(f"Page: {out / _PAGE[0]}")
