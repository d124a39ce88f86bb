"""Command line: ``frictionjoint demo | close-loop | identify | compare | install | check | ...``.

One function per command; `terminal` prints results, `main` handles errors.
"""

import signal
import sys
import warnings
from typing import Annotated, Any, NoReturn

import typer

from frictionjoint.cli.data import data
from frictionjoint.cli.demo import demo
from frictionjoint.cli.export import export
from frictionjoint.cli.fits import close_loop, identify
from frictionjoint.cli.inspect import inspect
from frictionjoint.cli.look import evaluate, plot
from frictionjoint.cli.models import check, install, uninstall, view
from frictionjoint.cli.motors import motors
from frictionjoint.cli.plain_help import PlainCommand, PlainGroup
from frictionjoint.cli.reports import compare, drift, sample
from frictionjoint.errors import FrictionJointError

# what was warned of in this run
_warned: set[str] = set()
_INTERRUPTED = 128 + signal.SIGINT
# click's error of wrong usage, wherever this version of typer keeps click
_UsageError: Any = typer.BadParameter.__base__

app = typer.Typer(
    cls=PlainGroup,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    help=(
        "Identify joint friction from logs and simulate it in MuJoCo, accurate at low speed.\n\n"
        "Start with `frictionjoint demo`. With logs of your own joint:\n\n"
        "1. `plot` draws a log before you fit anything.\n"
        "2. `close-loop` fits the friction of the joint, finds what the model lacks, adds it, and "
        "reports the error before and after on held-out data.\n"
        "3. `identify` only fits the friction and writes the parameters; `compare` draws "
        "parameters or reports side by side, `inspect` prints friction numbers.\n"
        "4. `evaluate` states the error of any model on logs, without fitting.\n"
        "5. `install` writes an MJCF with friction, `uninstall` removes it; `check` says whether "
        "the time step is short enough, `view` opens MuJoCo's viewer.\n\n"
        "Each command's `--help` has examples; `--json` prints results for a script. "
        "No log yet? `frictionjoint data list` names public ones.\n\n"
        "Exit codes: 0 done; 1 a changed number (`drift`), a finding (`check --strict`), an error "
        "of this program; 2 bad input or wrong usage, one line on stderr, nothing written; 130 "
        "interrupted; 143 terminated."
    ),
)


def _versions(wanted: bool) -> None:
    if wanted:
        from importlib import metadata  # it takes a tenth of the time that --help takes

        names = ("frictionjoint", "mujoco", "numpy", "scipy")
        typer.echo("\n".join(f"{name} {metadata.version(name)}" for name in names))
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_versions, is_eager=True, help="Print the versions."),
    ] = False,
) -> None:
    """Options that all commands share; the help text is that of the app."""


fits = demo, plot, close_loop, evaluate, identify, compare, inspect, sample, drift
for command in (*fits, install, uninstall, check, view, export):
    app.command(cls=PlainCommand)(command)
app.add_typer(motors, name="motors")
app.add_typer(data, name="data")


def main() -> None:
    """Run the command line. Bad input gives one line and exit code 2, an interruption exit code 130
    (terminated: 143); no incomplete output remains in any of these cases."""
    signal.signal(signal.SIGTERM, _terminated)
    warnings.showwarning = _one_line
    try:
        code = app(sys.argv[1:] or ["--help"], prog_name="frictionjoint", standalone_mode=False)
    except FrictionJointError as error:
        _fail(str(error), 2)
    except _UsageError as error:
        command = error.ctx.command_path if error.ctx else "frictionjoint"
        _fail(f"{error.format_message().rstrip('.')}; see {command} --help", 2)
    except KeyboardInterrupt:
        code = _INTERRUPTED
    if code == _INTERRUPTED:
        _fail("interrupted, nothing was written", _INTERRUPTED)
    raise SystemExit(code)


def _fail(text: str, code: int) -> NoReturn:
    typer.echo(f"frictionjoint: {' '.join(text.split())}", err=True)
    raise SystemExit(code)


def _terminated(number: int, frame: Any) -> NoReturn:
    """Exit normally, so that unfinished files are removed."""
    raise SystemExit(128 + number)


def _one_line(message: Warning | str, *where: Any, **named: Any) -> None:
    """Warnings as one line each, once: a model is read several times."""
    text = str(message)
    if text not in _warned:
        _warned.add(text)
        typer.echo(f"frictionjoint: {text}", err=True)
