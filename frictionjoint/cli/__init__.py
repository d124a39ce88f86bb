"""Command line: ``frictionjoint demo | close-loop | identify | compare | install | check | data``.

One function a command; what they print is in `terminal`, how they end is in `main`.
"""

import json
import shlex
import signal
import sys
import warnings
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, NoReturn, TextIO

import typer
from rich.table import Table

from frictionjoint.cli.compare import compare
from frictionjoint.cli.data import data
from frictionjoint.cli.export import export
from frictionjoint.cli.motors import motors
from frictionjoint.cli.terminal import console, progress, show_estimates, show_report
from frictionjoint.errors import FrictionJointError, LogError, ParameterError
from frictionjoint.laws import LAWS

_INTERRUPTED = 130
# click's error of wrong usage, wherever this version of typer keeps click
_UsageError: Any = typer.BadParameter.__base__

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    help=(
        "Joint friction for MuJoCo that is true at low speed and learns from logs.\n\n"
        "Start with `frictionjoint demo`. With logs of your own joint:\n\n"
        "1. `close-loop` fits the friction of the joint, finds what the model still lacks, adds "
        "it, and reports the error before and after on data held out.\n"
        "2. `identify` stops after the fit and writes the parameters; `compare` draws them "
        "beside others.\n"
        "3. `install` writes an MJCF that carries the friction itself; `check` tells whether its "
        "time step suits it and what it costs.\n\n"
        "Each command's `--help` has examples; `--json` prints results for a script. "
        "No log yet? `frictionjoint data list` names public ones. "
        "Bad input ends in one line and exit code 2, and writes nothing."
    ),
)

Logs = Annotated[
    list[Path],
    typer.Argument(metavar="LOG", help="CSV, Parquet, npz, mat or XL330 json; ROS 2 bags."),
]
Model = Annotated[
    Path, typer.Option("--model", metavar="MJCF", help="The robot, without its friction.")
]
Joint = Annotated[
    str, typer.Option("--joint", metavar="NAME", help="The joint in the MJCF and in the logs.")
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="OURS=THEIRS",
        help="A foreign column name, e.g. time_s=t. Repeatable.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
_LAW = "Friction law to fit: " + ", ".join(LAWS) + "."
Law = Annotated[str, typer.Option("--law", help=_LAW)]
LawOrBest = Annotated[
    str | None,
    typer.Option(
        "--law", help=_LAW + f" Default: {LAWS[0]}, in the result another where clearly better."
    ),
]
Seed = Annotated[int, typer.Option(help="Of the random tests; equal seeds, equal reports.")]


def _versions(wanted: bool) -> None:
    if wanted:
        names = ("frictionjoint", "mujoco", "numpy", "numba")
        typer.echo("\n".join(f"{name} {metadata.version(name)}" for name in names))
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_versions, is_eager=True, help="Print the versions."),
    ] = False,
) -> None:
    """What every command shares; its help is the app's."""


@app.command()
def demo() -> None:
    """Stick-slip of the KUKA joint, then the loop on a shipped log.

    Writes ./frictionjoint-demo/ with report.html, report.json, model.xml and stick_slip.svg.

    Example: `frictionjoint demo`, then open frictionjoint-demo/report.html
    """
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import write_files, write_report
    from frictionjoint.simulate.stick_slip import draw, kuka_model, stick_slip

    out = Path("frictionjoint-demo")
    with progress() as told:
        told("stick-slip of the KUKA IR 361 joint")
        ours, native = stick_slip(kuka_model()), stick_slip(kuka_model(), native=True)
        write_files(out, {"stick_slip.svg": draw(ours, native)})
        folder = Path(str(files("frictionjoint.demo")))
        read = [_read(folder / f"{n}.csv", "joint", {}) for n in ("pick_and_place", "ramps")]
        kept = [_read(folder / "multisine.csv", "joint", {})]
        report = close_loop(read, folder / "joint.xml", "joint", kept, progress=told)
        write_report(report, out, "frictionjoint demo")
    typer.echo(ours.summary())
    typer.echo("")
    show_report(report)
    typer.echo(f"Open {out / 'report.html'} and {out / 'stick_slip.svg'}")


@app.command("close-loop")
def close_loop_command(
    logs: Logs,
    model: Model,
    joint: Joint,
    out: Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Where the report goes.")],
    held_out: Annotated[
        list[str] | None,
        typer.Option(
            "--held-out",
            metavar="LOG|FRACTION",
            help="A log, or a fraction of each log's end (0.25). Repeatable. Default 0.25.",
        ),
    ] = None,
    law: LawOrBest = None,
    column: Columns = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Fit, find what is missing, add it, report before and after.

    Writes FOLDER/report.html (for people), report.json (for scripts) and model.xml (to simulate).

    Examples:

    `frictionjoint close-loop a.csv b.csv --held-out c.csv --model arm.xml --joint elbow --out out`

    `frictionjoint close-loop a.csv --held-out 0.3 --column time_s=t --model arm.xml --joint elbow
    --out out --json`
    """
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import write_report

    with progress() as told:
        fitted, kept = _split(logs, held_out or ["0.25"], joint, _mapping(column))
        report = close_loop(fitted, model, joint, kept, seed, told, law)
        told("writing the report")
        write_report(report, out, shlex.join(["frictionjoint", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
    else:
        show_report(report)
        typer.echo(f"Report: {out / 'report.html'}   Model: {out / 'model.xml'}")


@app.command()
def identify(
    logs: Logs,
    model: Model,
    joint: Joint,
    out: Annotated[Path, typer.Option("--out", metavar="TOML", help="Parameter file to write.")],
    law: Law = LAWS[0],
    column: Columns = None,
    as_json: Json = False,
) -> None:
    """Fit the friction law of one joint and write its parameters.

    Example: `frictionjoint identify a.csv --model arm.xml --joint elbow --out elbow.toml`

    Another law: `... --law lugre --out lugre.toml`, then `frictionjoint compare *.toml`
    """
    from frictionjoint.diagnose.intervals import stated_covariance
    from frictionjoint.files import toml_text
    from frictionjoint.identify.fit import fit
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.rest import resolved
    from frictionjoint.identify.result import law_estimates, law_parameters, require_gain
    from frictionjoint.identify.rigid_body import RigidBody
    from frictionjoint.identify.rival_shape import forms_of
    from frictionjoint.measured.bounded import bounded
    from frictionjoint.report.write import write_files

    with progress() as told:
        mapping = _mapping(column)
        body = RigidBody(model, joint)
        read = bounded([_read(path, joint, mapping) for path in logs])
        prepared = prepare(read, body)
        forms = forms_of(law)
        found = fit(prepared, progress=told, forms=forms)
        prepared, fitted = resolved(prepared, found, forms)
        require_gain(fitted)
        estimates = law_estimates(fitted, stated_covariance(prepared, fitted), body.slide)
        write_files(out.parent, {out.name: toml_text(law_parameters(fitted))})
    if as_json:
        rows = {name: x.to_dict() for name, x in estimates.items()}
        typer.echo(json.dumps({"torque_rms": fitted.rms, "parameters": rows}, indent=2))
        return
    show_estimates(list(estimates.items()))
    unit = "N" if body.slide else "N m"
    typer.echo(f"Residual {fitted.rms:.4g} {unit} of {fitted.target_rms:.4g} {unit}. Wrote {out}")


app.command()(compare)


@app.command()
def install(
    mjcf: Annotated[Path, typer.Argument(metavar="MJCF", help="Model to add friction to.")],
    joint: Annotated[
        list[str],
        typer.Option("--joint", metavar="NAME=TOML", help="Joint and its parameters. Repeatable."),
    ],
    out: Annotated[Path, typer.Option("--out", metavar="MJCF", help="Model to write.")],
) -> None:
    """Write an MJCF that carries friction itself.

    Examples:

    `frictionjoint install arm.xml --joint elbow=elbow.toml --out arm_friction.xml`

    `frictionjoint install arm.xml --joint elbow=e.toml --joint wrist=w.toml --out arm_friction.xml`
    """
    import mujoco

    from frictionjoint.files import read_parameters
    from frictionjoint.identify.rigid_body import compile_model
    from frictionjoint.report.write import write_files
    from frictionjoint.simulate.carrier import install as install_spec

    friction, effects = {}, {}
    for text in joint:
        name, equals, path = text.partition("=")
        if not equals:
            raise ParameterError(f"--joint {text}: write NAME=params.toml")
        if name in friction:
            raise ParameterError(f"--joint {name} is given twice: keep one")
        carried = read_parameters(Path(path))
        friction[name], effects[name] = carried.parameters, carried.effects
    compile_model(mjcf)
    spec = mujoco.MjSpec.from_file(str(mjcf))
    install_spec(spec, friction, effects)
    spec.compile()
    write_files(out.parent, {out.name: spec.to_xml()})
    typer.echo(f"Wrote {out} with friction in {', '.join(friction)}.")


@app.command()
def check(
    mjcf: Annotated[Path, typer.Argument(metavar="MJCF", help="Model that carries friction.")],
    as_json: Json = False,
) -> None:
    """Tell what friction an MJCF carries and whether its time step suits it.

    Examples: `frictionjoint check arm_friction.xml`, `frictionjoint check report/model.xml --json`
    """
    from frictionjoint.simulate.carrier import load_model
    from frictionjoint.simulate.check import check_model

    findings = check_model(load_model(mjcf))
    if as_json:
        typer.echo(json.dumps(findings, indent=2))
        return
    table = Table("joint", "law", "stiffness", "h sqrt(K/J)", "effects", "remark")
    for row in findings:
        table.add_row(
            row["joint"],
            row["law"],
            f"{row['stiffness']:.4g}",
            f"{row['step_ratio']:.3g}",
            ", ".join(row["effects"]) or "none",
            row["remark"],
        )
    console().print(table)


app.command()(export)
app.add_typer(motors, name="motors")
app.add_typer(data, name="data")


def _split(
    paths: list[Path], held_out: list[str], joint: str, mapping: dict[str, str]
) -> tuple[list[Any], list[Any]]:
    """Logs to fit and logs held out; a fraction cuts the end off every log to fit."""
    from frictionjoint.measured.log import split_in_time

    fractions = [float(text) for text in held_out if _is_number(text)]
    names = [Path(text) for text in held_out if not _is_number(text)]
    if len(fractions) > 1:
        raise LogError("--held-out: give one fraction at most")
    same = [path for path in paths if path.resolve() in {n.resolve() for n in names}]
    if same:
        raise LogError(f"{same[0]} is both fitted and held out: give it once")
    fitted = [_read(path, joint, mapping) for path in paths]
    kept = [_read(path, joint, mapping) for path in names]
    if fractions:
        pairs = [split_in_time(log, fractions[0]) for log in fitted]
        fitted = [first for first, _ in pairs]
        kept += [last for _, last in pairs]
    return fitted, kept


def _read(path: Path, joint: str, mapping: dict[str, str]) -> Any:
    from frictionjoint.measured.readers import read_log

    return read_log(path, joint, mapping)


def _mapping(column: list[str] | None) -> dict[str, str]:
    found = {}
    for text in column or []:
        ours, equals, theirs = text.partition("=")
        if not (ours and equals and theirs):
            raise LogError(f"--column {text}: write ours=theirs, e.g. time_s=t")
        found[ours] = theirs
    return found


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def main() -> None:
    """Run the command line.

    Bad input becomes one line and exit code 2, an interruption exit code 130 (terminated: 143);
    in all of them nothing half-written stays.
    """
    signal.signal(signal.SIGTERM, _terminated)
    warnings.showwarning = _one_line
    try:
        code = app(sys.argv[1:] or ["--help"], prog_name="frictionjoint", standalone_mode=False)
    except FrictionJointError as error:
        _fail(str(error), 2)
    except _UsageError as error:
        _fail(f"{error.format_message().rstrip('.')}; see {_path(error)} --help", 2)
    except KeyboardInterrupt:
        code = _INTERRUPTED
    if code == _INTERRUPTED:
        _fail("interrupted, nothing was written", _INTERRUPTED)
    raise SystemExit(code)


def _fail(text: str, code: int) -> NoReturn:
    typer.echo(f"frictionjoint: {' '.join(text.split())}", err=True)
    raise SystemExit(code)


def _path(error: Any) -> str:
    return error.ctx.command_path if error.ctx else "frictionjoint"


def _terminated(number: int, frame: Any) -> NoReturn:
    """A plain exit, so that what was begun is cleared away."""
    raise SystemExit(128 + number)


def _one_line(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Warnings as one line, without the place in our code."""
    typer.echo(f"frictionjoint: {message}", err=True)
