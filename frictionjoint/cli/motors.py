"""The command `motors`: identified motors, and parameter files of BAM."""

from pathlib import Path
from statistics import mean, stdev
from typing import Annotated

import typer

from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import PlainCommand, PlainGroup, argument, option
from frictionjoint.cli.terminal import show_table

motors = typer.Typer(
    cls=PlainGroup,
    invoke_without_command=True,
    rich_markup_mode="markdown",
    help=(
        "Motors and joints identified from public logs, and parameter files of BAM.\n\n"
        "Examples:\n\n`frictionjoint motors list`\n\n"
        "`frictionjoint motors get ur10_j1 --out j1.toml`, for `frictionjoint install`"
    ),
)
Out = Annotated[Path, option("FILE", "File to write.")]
Bam = Annotated[Path, argument("JSON", "Parameter file of BAM.")]


@motors.callback()
def listed(context: typer.Context) -> None:
    """Print the list if no command is named."""
    if context.invoked_subcommand is None:
        list_command(None, False)


@motors.command("list", cls=PlainCommand)
def list_command(
    robot: Annotated[
        str | None, option("TEXT", "Only motors with this text in their name or title.")
    ] = None,
    as_json: Json = False,
) -> None:
    """List the motors with law, effects, source and licence.

    Examples: `frictionjoint motors list`, `frictionjoint motors list --robot panda`
    """
    from frictionjoint.errors import ParameterError
    from frictionjoint.motors.library import TEXTS, list_motors

    wanted = (robot or "").lower()
    found = [x for x in list_motors() if wanted in x.name.lower() or wanted in x.title.lower()]
    if not found:
        titles = ", ".join(sorted({x.title.partition(",")[0] for x in list_motors()}))
        raise ParameterError(f"--robot {robot}: no motor of this name, there are {titles}")
    if as_json:
        keys = *TEXTS, "unit", "fit", "stderr", "found", "units"
        rows = [
            {
                "name": x.name,
                "law": x.friction.parameters.law,
                "effects": [e.effect.name for e in x.friction.effects],
                **{key: getattr(x, key) for key in keys},
            }
            for x in found
        ]
        print_json(rows)
        return
    cells = []
    for x in found:
        effects = ", ".join(e.effect.title or e.effect.name for e in x.friction.effects) or "none"
        ends = (x.fit.get(f"torque_held_out{when}") for when in ("_before", ""))
        shown = " → ".join("?" if end is None else f"{end:.3g}" for end in ends) + f" {x.unit}"
        cells.append((x.name, x.title, x.friction.parameters.law, effects, shown, x.licence))
    show_table(("name", "what", "law", "effects", "torque error", "licence"), cells)
    typer.echo("Torque error: rms on held-out data, with the law alone and with the effects.")


@motors.command("show", cls=PlainCommand)
def show_command(
    name: Annotated[str, argument("NAME", "Name, as `motors list` prints it.")],
    as_json: Json = False,
) -> None:
    """Show the numbers of a motor with errors, its friction-speed curve, source and conditions.

    Example: `frictionjoint motors show ur10_j1`
    """
    from frictionjoint.describe import effect_value, law_values
    from frictionjoint.effects.catalogue import title
    from frictionjoint.motors.library import friction_speed, get_motor

    motor = get_motor(name)
    parameters = motor.friction.parameters
    numbers = {k: v for k, v in parameters.to_dict().items() if isinstance(v, float)}
    speeds, curves = friction_speed(motor)
    if as_json:
        curve = {"speed": speeds.tolist()} | {side: F.tolist() for side, F in curves.items()}
        content = {
            "name": name,
            "unit": motor.unit,
            "numbers": numbers,
            "stderr": motor.stderr,
            "friction_speed": curve,
            "units": motor.units,
            **{key: getattr(motor, key) for key in ("conditions", "verdict", "remark")},
        }
        print_json(content)
        return
    typer.echo(f"{motor.title}: law {parameters.law}")
    rows = []
    for x in law_values(parameters, motor.unit == "N"):
        error = motor.stderr.get(x.symbol, motor.stderr.get(f"{x.symbol}_pos"))
        rows.append((x.meaning, x.symbol, x.text, "-" if error is None else f"{error:.2g}"))
    for effect, found in motor.found.items():
        for key, value in found.items():
            quantity, text = effect_value(effect, key, value, motor.unit == "N")
            rows.append((f"{title(effect)}: {quantity}", key, text, "-"))
    show_table(("number", "symbol", "value", "standard error"), rows)
    speed_unit = "m/s" if motor.unit == "N" else "rad/s"
    head = f"speed, {speed_unit}", f"positive, {motor.unit}", f"negative, {motor.unit}"
    points = zip(speeds, curves["pos"], -curves["neg"], strict=True)
    show_table(head, ([f"{x:.3g}" for x in point] for point in points))
    if motor.units:
        symbols = list(next(iter(motor.units.values())))
        units = [(unit, *(f"{x[key]:.3g}" for key in symbols)) for unit, x in motor.units.items()]
        spreads = [[values[key] for values in motor.units.values()] for key in symbols]
        both = "mean ± deviation", *(f"{mean(x):.3g} ± {stdev(x):.2g}" for x in spreads)
        show_table(["unit", *symbols], [*units, both])
    for key in ("source", "licence", "conditions", "command", "verdict"):
        if text := getattr(motor, key):
            typer.echo(f"{key}: {text.replace('-', ' ') if key == 'verdict' else text}")
    if motor.remark:
        typer.echo(motor.remark)


@motors.command("get", cls=PlainCommand)
def get_command(
    name: Annotated[str, argument("NAME", "Name, as `motors list` prints it.")],
    out: Out,
    force: Force = False,
) -> None:
    """Write the parameter file of a motor, for `frictionjoint install`.

    Example: `frictionjoint motors get ur10_j1 --out j1.toml`
    """
    from frictionjoint.files import toml_text
    from frictionjoint.motors.library import get_motor
    from frictionjoint.report.write import write_files

    require_writable(out, (), force)
    motor = get_motor(name)
    friction = motor.friction
    write_files(out.parent, {out.name: toml_text(friction.parameters, friction.effects)})
    typer.echo(f"{motor.title}\nsource: {motor.source}\nlicence: {motor.licence}")
    if motor.remark:
        typer.echo(motor.remark)
    typer.echo(f"Wrote {out}")


@motors.command("from-bam", cls=PlainCommand)
def from_bam_command(bam: Bam, out: Out, force: Force = False) -> None:
    """Convert a parameter file of BAM, models M1 to M6, to ours.

    Example: `frictionjoint motors from-bam bam/params/xl330/m4.json --out xl330.toml`
    """
    from frictionjoint.files import toml_text
    from frictionjoint.motors.bam import from_bam, read_bam
    from frictionjoint.report.write import write_files

    require_writable(out, [bam], force)
    friction, said = from_bam(read_bam(bam))
    write_files(out.parent, {out.name: toml_text(friction.parameters, friction.effects)})
    typer.echo(f"Wrote {out}")
    for line in said:
        typer.echo(f"Without counterpart: {line}")


@motors.command("to-bam", cls=PlainCommand)
def to_bam_command(
    parameters: Annotated[Path, argument("TOML", "Parameter file, as `identify` writes it.")],
    like: Annotated[Path, option("JSON", "File of BAM that supplies the actuator, kt and R.")],
    out: Out,
    model: Annotated[
        str | None, option("M", "m1 to m6. Default: the simplest that suffices.")
    ] = None,
    force: Force = False,
) -> None:
    """Convert our parameter file to one of BAM.

    Example: `frictionjoint motors to-bam xl330.toml --like bam/params/xl330/m1.json --out m4.json`
    """
    from frictionjoint.files import read_parameters
    from frictionjoint.motors.bam import read_bam, to_bam
    from frictionjoint.report.write import write_files

    require_writable(out, [parameters, like], force)
    made, said = to_bam(read_parameters(parameters), read_bam(like), model)
    write_files(out.parent, {out.name: made.to_json()})
    typer.echo(f"Wrote {out}, model {made.model} of {made.actuator}")
    for line in said:
        typer.echo(f"Without counterpart: {line}")
