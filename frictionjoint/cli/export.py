"""``frictionjoint export``: the friction of a model in the terms of another program."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Target(StrEnum):
    """What a model can be exported to."""

    C = "c"


def export(
    model: Annotated[
        Path, typer.Argument(metavar="MODEL", help="MJCF that carries friction, see `install`.")
    ],
    to: Annotated[Target, typer.Option("--to", help="What to write.", show_default=False)],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Where to write it.")],
) -> None:
    """Write the friction of a model in the terms of another program, and say what is lost.

    `c`: a C99 header for controllers, the same torque as in simulation.

    Example: `frictionjoint export arm_friction.xml --to c --out arm_friction.h`
    """
    from frictionjoint.export.c import header, lost_effects
    from frictionjoint.report.write import write_files
    from frictionjoint.simulate.carrier import load_model, read_friction

    friction = read_friction(load_model(model))
    write_files(out.parent, {out.name: header(friction, out.name)})
    typer.echo(f"Wrote {out}: friction of {', '.join(friction)}.")
    for lost in lost_effects(friction):
        typer.echo(f"Lost, because only a log knows what it follows: {lost}")
