"""The command `export`: convert the friction of a model for another program."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import Columns, columns_of
from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import progress, show_table
from frictionjoint.errors import ParameterError
from frictionjoint.export.targets import FILES


def export(
    model: Annotated[Path, argument("MODEL", "MJCF that contains friction, see `install`.")],
    to: Annotated[str, option("TARGET", "One of the programs above.")],
    out: Annotated[Path, option("PATH", "File to write, or a folder for it.")],
    log: Annotated[Path | None, option("LOG", "Motion to fit and to state the error for.")] = None,
    speeds: Annotated[
        str | None,
        option(
            "LOW:HIGH",
            "Speeds to fit and to state the error for, rad/s or m/s. Default without a log: "
            "0.1 to 20 Stribeck velocities, or up to 1 rad/s if friction does not fall with "
            "speed; for isaac, the speeds above the Stribeck range.",
        ),
    ] = None,
    column: Columns = None,
    lugre: Annotated[
        bool,
        typer.Option("--lugre", help="For `native`: MuJoCo's own LuGre, one actuator per joint."),
    ] = False,
    yielding: Annotated[
        bool,
        typer.Option(
            "--yield", help="For `native` on MuJoCo 4.0: springs that yield represent presliding."
        ),
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Convert the friction of a model for another program, and state what is lost.

    * `c`: a C99 header for controllers, with the same torque as the simulation.
    * `native`: an MJCF with MuJoCo's own friction, for every program that loads MJCF.
    * `mjx`: the same for MJX, without what MJX does not support.
    * `urdf`: links, joints and their `<dynamics>`.
    * `mjlab`: an actuator configuration with the complete friction.
    * `newton`, `isaac`: joint parameters of Newton and Isaac Lab.

    Examples:

    `frictionjoint export arm_friction.xml --to c --out arm_friction.h`

    `frictionjoint export arm_friction.xml --to native --log motion.csv --out arm_native.xml`
    """
    from frictionjoint.export.run import export as run
    from frictionjoint.export.run import output_file
    from frictionjoint.report.write import write_files

    if to not in FILES:
        raise ParameterError(f"--to {to}: give one of {', '.join(FILES)}")
    if log is not None and speeds is not None:
        raise ParameterError("--speeds and --log: give one of them")
    file = output_file(out, to)
    require_writable(file, [model, *([log] if log else [])], force)
    with progress() as say:
        say(f"reading {model.name}")
        done = run(model, to, file, _range(speeds), log, columns_of(column), lugre, yielding, say)
        write_files(file.parent, {file.name: done.text})
    if as_json:
        losses = [asdict(loss) for loss in done.losses]
        print_json({"file": str(file), "lost": done.lost, "losses": losses})
        return
    typer.echo(f"Wrote {file}")
    for lost in done.lost:
        typer.echo(f"Lost: {lost}")
    if done.losses:
        rows = []
        for x in done.losses:
            errors = (_error(lost, x.torque, x.unit) for lost in (x.sliding_lost, x.torque_lost))
            torques = (f"{x.torque:.3g} {x.unit}", *errors)
            errors = (
                f"{1e3 * e:.3g} m{x.unit_of_position}" for e in (x.error, x.error_exported, x.apart)
            )
            rows.append((x.joint, *torques, *errors))
        head = "joint", "friction", "error in sliding", "error in all", "position error, ours"
        show_table((*head, "exported", "difference"), rows)
        typer.echo(
            f"All values are rms, along {'; '.join(sorted({x.motion for x in done.losses}))}. "
            "Sliding: away from rest and reversals. Position errors: in a soft position loop, with "
            "our friction, with the exported one, and the difference of these two runs."
        )


def _error(error: float | None, torque: float, unit: str) -> str:
    """A torque error and its fraction of the friction torque."""
    if error is None:
        return "no sliding"
    return f"{error:.3g} {unit}" + (f" ({error / torque:.0%})" if torque else "")


def _range(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        low, high = (float(x) for x in text.split(":"))
    except ValueError:
        raise ParameterError(f"--speeds {text}: write LOW:HIGH, e.g. 0.01:2") from None
    if not 0.0 < low < high < float("inf"):
        raise ParameterError(f"--speeds {text}: LOW must be above 0 and below HIGH")
    return low, high
