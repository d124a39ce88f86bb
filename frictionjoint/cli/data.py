"""The command `data`: public measured logs, fetched from their authors' repositories."""

from typing import Annotated

import typer

from frictionjoint.cli.output import Json, print_json
from frictionjoint.cli.plain_help import PlainCommand, PlainGroup, argument
from frictionjoint.cli.terminal import progress, show_table

data = typer.Typer(
    cls=PlainGroup,
    rich_markup_mode="markdown",
    help=(
        "Public measured logs to try the commands on.\n\n"
        "Fetched from their authors' repositories, hashes checked; nothing is shipped with the "
        "package. `FRICTIONJOINT_DATA` may name a folder that contains the files; "
        "then the network is not used.\n\n"
        "Examples: `frictionjoint data list`, `frictionjoint data get xl330`"
    ),
)


@data.command("list", cls=PlainCommand)
def list_command(as_json: Json = False) -> None:
    """List the data sets with source and licence.

    Example: `frictionjoint data list`
    """
    from frictionjoint.measured.registry import list_data

    found = list_data()
    if as_json:
        shown = ("name", "title", "licence", "source", "files", "logs")
        rows = [{key: getattr(x, key) for key in shown} | {"files": dict(x.files)} for x in found]
        print_json(rows)
        return
    cells = ((x.name, x.title, str(len(x.files)), x.licence, x.source) for x in found)
    show_table(("name", "what", "files", "licence", "source"), cells)


@data.command("get", cls=PlainCommand)
def get_command(
    name: Annotated[str, argument("NAME", "Name, as `data list` prints it.")], as_json: Json = False
) -> None:
    """Fetch a data set and print where its logs are.

    Example: `frictionjoint data get emps`
    """
    from frictionjoint.measured.registry import get_data, list_data

    with progress() as say:
        say(f"fetching {name}")
        folder = get_data(name)
    found = next(x for x in list_data() if x.name == name)
    logs = [str(folder / log) for log in found.logs]
    if as_json:
        row = {"name": name, "licence": found.licence, "source": found.source, "logs": logs}
        print_json(row)
        return
    typer.echo(f"{found.title}\nlicence: {found.licence}\nsource: {found.source}\nlogs:")
    for log in logs:
        typer.echo(f"  {log}")
