"""Command line: ``frictionjoint demo | close-loop | identify | compare | install | check | ...``.

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

from frictionjoint.cli.compare import compare
from frictionjoint.cli.data import data
from frictionjoint.cli.export import export
from frictionjoint.cli.logs import (
    Columns,
    ControllerFile,
    Fixed,
    Gain,
    Model,
    Reading,
    Signals,
    Wrap,
    joints_of,
    models_of,
    paths_of,
    poses,
    split,
    the_joint,
)
from frictionjoint.cli.models import check, install, uninstall, view
from frictionjoint.cli.motors import motors
from frictionjoint.cli.output import Force, require_writable
from frictionjoint.cli.robot import (
    RobotRequest,
    Wanted,
    close_loop_of_robot,
    close_loop_of_units,
    units_of,
)
from frictionjoint.cli.sample import sample
from frictionjoint.cli.terminal import console, progress, show_estimates, show_report
from frictionjoint.errors import FrictionJointError, LogError, ModelError
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
        "together with others.\n"
        "3. `install` writes an MJCF that carries the friction itself, `uninstall` takes it out "
        "again; `check` says whether its time step suits it, `view` opens MuJoCo's viewer.\n\n"
        "Each command's `--help` has examples; `--json` prints results for a script. "
        "No log yet? `frictionjoint data list` names public ones. "
        "Bad input ends in one line and exit code 2, and writes nothing."
    ),
)

Logs = Annotated[
    list[Path],
    typer.Argument(metavar="LOG", help="CSV, Parquet, npz, mat or XL330 json; ROS 2 bags."),
]
LogsOrUnits = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="LOG", help="CSV, Parquet, npz, mat or XL330 json; ROS 2 bags. None with --unit."
    ),
]
Joint = Annotated[
    str | None,
    typer.Option(
        "--joint",
        metavar="NAME",
        help="The joint in the MJCF and in the logs. Default: the model's only one.",
    ),
]
Joints = Annotated[
    list[str] | None,
    typer.Option(
        "--joint",
        metavar="NAME",
        help="A joint in the model and in the logs. Repeatable. Default: all with a drive.",
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
Seed = Annotated[int, typer.Option(min=0, help="Of the random tests; equal seeds, equal reports.")]


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
    """What all commands have in common; its help is the app's."""


@app.command()
def demo() -> None:
    """Stick-slip of the KUKA joint, then the loop on a shipped log.

    Writes ./frictionjoint-demo/ with report.html, report.json, model.xml and stick_slip.svg.

    Example: `frictionjoint demo`, then open frictionjoint-demo/report.html
    """
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import FILES, write_files, write_report
    from frictionjoint.simulate.stick_slip import draw, kuka_model, stick_slip

    out = Path("frictionjoint-demo")
    require_writable(out, (), force=False, files=FILES)
    with progress() as say:
        say("stick-slip of the KUKA IR 361 joint")
        ours, native = stick_slip(kuka_model()), stick_slip(kuka_model(), native=True)
        write_files(out, {"stick_slip.svg": draw(ours, native)})
        folder = Path(str(files("frictionjoint.demo")))
        logs = Reading("joint")
        read = [logs.read(folder / f"{n}.csv") for n in ("pick_and_place", "ramps")]
        kept = [logs.read(folder / "multisine.csv")]
        report = close_loop(read, folder / "joint.xml", "joint", kept, progress=say)
        write_report(report, out, "frictionjoint demo")
    typer.echo(ours.summary())
    typer.echo("")
    show_report(report)
    typer.echo(f"Open {out / 'report.html'} and {out / 'stick_slip.svg'}")


@app.command("close-loop")
def close_loop_command(
    model: Model,
    out: Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Where the report goes.")],
    logs: LogsOrUnits = None,
    joint: Joints = None,
    held_out: Annotated[
        list[str] | None,
        typer.Option(
            "--held-out",
            metavar="LOG|FRACTION",
            help="A log, or a fraction of each log's end (0.25). Repeatable. Default 0.25.",
        ),
    ] = None,
    law: LawOrBest = None,
    fixed: Fixed = None,
    controller: ControllerFile = None,
    refine: Annotated[
        bool,
        typer.Option(
            "--refine",
            help="Fit all numbers of the named model to the simulated motion in the end; it is "
            "taken where it predicts logs left out better.",
        ),
    ] = False,
    gain: Gain = None,
    column: Columns = None,
    signal: Signals = None,
    wrap: Wrap = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(
            "--unit",
            metavar="NAME=LOG",
            help="A log of one of several robots of a kind, in place of LOG; a unit may have "
            "several. Repeatable.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Dask scheduler, tcp://HOST:PORT, whose workers take the joints of a robot. The "
            "numbers are the same.",
        ),
    ] = None,
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit, find what is missing, add it, report before and after.

    Writes FOLDER/report.html (for people), report.json (for scripts) and model.xml (to simulate).

    Examples:

    `frictionjoint close-loop a.csv b.csv --held-out c.csv --model arm.xml --joint elbow --out out`

    `frictionjoint close-loop a.csv --held-out 0.3 --column time_s=t --model arm.xml --joint elbow
    --out out --json`

    A whole robot, every joint whose drive the logs hold: `frictionjoint close-loop a.csv b.csv
    --held-out c.csv --model arm.urdf --out out`

    Several robots of one kind: `frictionjoint close-loop --unit left=a.csv --unit right=b.csv
    --model arm.urdf --out out`
    """
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import FILES, write_report

    logs, held_out = logs or [], held_out or ["0.25"]
    if not (logs or unit):
        raise LogError("no log: give one or more, or units with --unit NAME=LOG")
    if not (unit or joint) and len(only := joints_of(model)) == 1:
        joint = only
    if unit or joint is None or len(joint) != 1:
        reading = Reading.of("", column, signal, wrap, gain)
        robot = models_of(model)
        if controller or refine:
            raise ModelError("--controller and --refine are for one joint: name it with --joint")
        if isinstance(robot, dict):
            raise ModelError("--model: several joints share one model, give one without a pattern")
        request = RobotRequest(logs, held_out, Path(robot), joint or [], reading)
        wanted = Wanted(out, force, seed, law, poses(fixed), as_json, scheduler)
        if unit:
            close_loop_of_units(request, units_of(unit), wanted)
        else:
            close_loop_of_robot(request, wanted)
        return
    if scheduler:
        raise LogError("--scheduler spreads the joints of a robot: leave it out with one --joint")
    with progress() as say:
        read = [*logs, *(Path(text) for text in held_out), *paths_of(model)]
        require_writable(out, read, force, FILES)
        reading = Reading.of(joint[0], column, signal, wrap, gain)
        fitted, kept = split(logs, held_out, reading)
        report = close_loop(
            fitted,
            models_of(model),
            joint[0],
            kept,
            seed,
            say,
            law,
            poses(fixed),
            controller,
            refine,
        )
        say("writing the report")
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
    out: Annotated[Path, typer.Option("--out", metavar="TOML", help="Parameter file to write.")],
    joint: Joint = None,
    law: Law = LAWS[0],
    fixed: Fixed = None,
    controller: ControllerFile = None,
    gain: Gain = None,
    column: Columns = None,
    signal: Signals = None,
    wrap: Wrap = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit the friction law of one joint and write its parameters.

    Example: `frictionjoint identify a.csv --model arm.xml --joint elbow --out elbow.toml`

    Another law: `... --law lugre --out lugre.toml`, then `frictionjoint compare *.toml`
    """
    from frictionjoint.control.controller import read_controller
    from frictionjoint.control.reconstruct import check_drive
    from frictionjoint.diagnose.intervals import stated_covariance
    from frictionjoint.files import toml_text, toml_text_without_scale
    from frictionjoint.identify.bodies import Bodies
    from frictionjoint.identify.fit import without_scale
    from frictionjoint.identify.gate import check as check_balance
    from frictionjoint.identify.gate import check_fit, scale_is_determined
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.result import (
        law_estimates,
        law_parameters,
        scale_note,
        units_of,
    )
    from frictionjoint.identify.rival_shape import forms_of
    from frictionjoint.identify.starts import fit
    from frictionjoint.identify.weights import reweighed
    from frictionjoint.measured.bounded import bounded
    from frictionjoint.report.write import write_files

    with progress() as say:
        require_writable(out, [*logs, *paths_of(model)], force)
        forms = forms_of(law)
        joint = the_joint(joint, model)
        bodies = Bodies(models_of(model), joint, poses(fixed))
        driven_by = read_controller(controller) if controller else None
        reading = Reading.of(joint, column, signal, wrap, gain)
        read = bounded([reading.read(path) for path in logs])
        said = bodies.check(read, ())
        body = bodies.of(read)[0]
        if driven_by:
            said += tuple(note for log in read for note in check_drive(log, driven_by))
        prepared = prepare(read, bodies.of(read), controller=driven_by)
        check_balance(prepared)
        found = fit(prepared, forms=forms, progress=say)
        prepared, fitted = reweighed(prepared, found)
        check_fit(prepared, fitted)
        scaled = scale_is_determined(prepared, fitted)
        if not scaled:
            fitted = without_scale(fitted)
        unit, _ = units_of(fitted, body.slide)
        estimates = law_estimates(fitted, stated_covariance(prepared, fitted), body.slide)
        parameters = law_parameters(fitted)
        toml = toml_text(parameters) if scaled else toml_text_without_scale(parameters, unit)
        write_files(out.parent, {out.name: toml})
    if as_json:
        rows = {name: x.to_dict() for name, x in estimates.items()}
        result = {"unit": unit, "torque_rms": fitted.rms, "parameters": rows}
        typer.echo(json.dumps(result, indent=2))
        return
    show_estimates(list(estimates.items()))
    for text in (*said, *scale_note(fitted)):
        console().print(f"* {text}", soft_wrap=True, markup=False)
    typer.echo(f"Residual {fitted.rms:.4g} {unit} of {fitted.target_rms:.4g} {unit}. Wrote {out}")


app.command()(compare)
app.command()(sample)


for command in (install, uninstall, check, view, export):
    app.command()(command)
app.add_typer(motors, name="motors")
app.add_typer(data, name="data")


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
