"""``frictionjoint compare``: laws and parameter sets side by side."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from frictionjoint.cli.output import Force, require_writable
from frictionjoint.cli.terminal import console, progress
from frictionjoint.errors import ParameterError


def compare(
    parameters: Annotated[
        list[Path],
        typer.Argument(metavar="TOML", help="Parameter files, as `identify` writes them."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Drawing: .html, .png or .svg."),
    ] = None,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Set laws and parameters side by side: breakaway, presliding, sliding.

    Every file's law is driven through the same three motions: a slow pull from rest, small
    reversals before sliding, and steady sliding over the speeds.

    Examples:

    `frictionjoint compare elbow.toml wrist.toml --json`

    `frictionjoint compare elbow.toml elbow_lugre.toml --out compare.html`
    """
    from frictionjoint.files import read_parameters
    from frictionjoint.report.compare import KINDS, compared, draw, rows
    from frictionjoint.report.write import write_files

    if out is not None and out.suffix.lower() not in KINDS:
        raise ParameterError(f"--out {out}: end it in {', '.join(KINDS)}")
    if out is not None:
        require_writable(out, parameters, force)
    with progress() as say:
        read = {}
        for i, path in enumerate(parameters):
            say(f"driving {path.name}, {i + 1} of {len(parameters)}")
            name = path.stem if path.stem not in read else str(path)
            if path in parameters[:i]:
                raise ParameterError(f"{path} is given twice: give it once")
            read[name] = read_parameters(path)
        found = compared(read)
        if out is not None:
            say("drawing")
            write_files(out.parent, {out.name: draw(found, out.suffix.lower())})
    if as_json:
        typer.echo(json.dumps({x.name: x.figures for x in found}, indent=2))
        return
    table = Table("", *(x.name for x in found))
    for name, cells in rows(found):
        table.add_row(name, *cells)
    console().print(table)
    if out is not None:
        typer.echo(f"Wrote {out}")
