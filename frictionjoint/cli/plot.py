"""The command `plot`: look at logs before anything is fitted."""

from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import NO_OPTIONS, LogOptions, Logs, log_paths, reads_logs
from frictionjoint.cli.output import Force, Open, open_page, require_writable
from frictionjoint.cli.plain_help import option
from frictionjoint.cli.terminal import progress, warnings_afterwards
from frictionjoint.errors import LogError

_KINDS = (".html", ".png", ".svg")


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
    if target.suffix.lower() not in _KINDS:
        raise LogError(f"--out {target}: the name must end in {', '.join(_KINDS)}")
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
