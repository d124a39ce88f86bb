"""The command `identify`: the friction law of one joint, without a search for effects."""

from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import (
    LAW_TO_FIT,
    NO_OPTIONS,
    LogOptions,
    Logs,
    Model,
    log_paths,
    models_of,
    paths_of,
    reads_logs,
    the_joint,
)
from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import option
from frictionjoint.cli.terminal import console, progress, show_table
from frictionjoint.law.names import LAWS


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
