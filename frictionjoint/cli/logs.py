"""Options of commands that read logs: which logs, and how to read them."""

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from frictionjoint.cli.plain_help import argument, option
from frictionjoint.errors import NO_JOINT, FrictionJointError, LogError, ModelError
from frictionjoint.law.names import LAWS

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    from frictionjoint.measured.log import JointLog

# texts of options
LOG_FORMATS = (
    "CSV, Parquet, npz, mat, HDF5, ROS bag, LeRobot data set (DATASET#0-7: episodes), or a folder "
    "of logs."
)
LAW_TO_FIT = f"Friction law to fit: {', '.join(LAWS)}."

Logs = Annotated[list[Path], argument("LOG", LOG_FORMATS)]
Joints = Annotated[
    list[str] | None,
    option(
        "NAME",
        "A joint in the model and in the logs. Repeatable. Default: all joints whose drive "
        "the logs contain.",
    ),
]
Columns = Annotated[
    list[str] | None,
    option(
        "OURS=THEIRS",
        "Column of your file, e.g. time_s=t; in a file without a header its number, from 1. "
        "time_s=500Hz: a sample rate instead of a column of times. Repeatable.",
    ),
]
Model = Annotated[
    list[str],
    option(
        "MJCF",
        "MJCF or URDF of the robot without friction. With several loads, one PATTERN=MJCF per "
        "load; the pattern matches the names of the logs. Repeatable.",
    ),
]


def models_of(model: list[str]) -> str | dict[str, str]:
    """An MJCF, or one per pattern of log names; FrictionJointError: several without a pattern."""
    if len(model) == 1 and "=" not in model[0]:
        return model[0]
    fix = "with several models write PATTERN=MJCF, e.g. 'heavy*=b.xml'"
    return by_name("--model", model, fix)


def paths_of(model: list[str]) -> list[Path]:
    models = models_of(model)
    return [Path(x) for x in (models.values() if isinstance(models, dict) else [models])]


def joints_of(model: list[str]) -> list[str]:
    """Names of the hinges and slides of a model; with several models, of the first."""
    from frictionjoint.model_files import ONE_DOF, compile_model

    compiled = compile_model(paths_of(model)[0])
    joints = range(compiled.njnt)
    return [compiled.joint(j).name for j in joints if int(compiled.jnt_type[j]) in ONE_DOF]


def the_joint(asked: str | None, model: list[str]) -> str:
    """The requested joint, or the model's only one with a name; ModelError if there is no such."""
    if asked is not None:
        return asked
    names, file = joints_of(model), paths_of(model)[0]
    if not any(names):
        none = "its joint has no name: name it in the model" if names else NO_JOINT
        raise ModelError(f"{file}: {none}")
    if len(names) > 1:
        has = ", ".join(name or "one without a name" for name in names)
        raise ModelError(f"{file}: which joint? It has {has}: name one with --joint")
    return names[0]


@dataclass(frozen=True)
class LogOptions:
    """Options of every command that reads logs, as given, in the order of the help."""

    gain: Annotated[
        float | None,
        option(
            "NUMBER",
            "Motor constant, N m per A or per V. Default: estimated from the load; where nothing "
            "is fitted, that of the model.",
        ),
    ] = None
    column: Columns = None
    signal: Annotated[
        list[str] | None,
        option("NAME", "A column that friction may depend on, e.g. a normal load. Repeatable."),
    ] = None
    wrap: Annotated[
        float | None,
        option(
            "RANGE",
            "Range at which positions wrap, rad (m). Wraps at one turn and at 25 rad are detected "
            "without this option.",
        ),
    ] = None
    unit: Annotated[
        list[str] | None,
        option(
            "QUANTITY=UNIT",
            "Unit of a quantity that is not in SI units: position=deg, time=ms, "
            "position=counts:4096 (per turn), or torque=-0.05, the factor to SI. Repeatable.",
        ),
    ] = None
    join: Annotated[
        bool,
        typer.Option(
            "--join",
            help="Each LOG is a folder with one file per signal; files given directly are one log.",
        ),
    ] = False
    drop_nan: Annotated[
        bool,
        typer.Option(
            "--drop-nan",
            help="Leave out rows with an empty cell or NaN, and say how many. Otherwise such logs "
            "are refused.",
        ),
    ] = False
    fixed: Annotated[
        list[str] | None,
        option(
            "JOINT=VALUE",
            "Position of a joint that the logs do not contain, rad or m; x,y,z,qw,qx,qy,qz of a "
            "floating base. Repeatable.",
        ),
    ] = None
    controller: Annotated[
        str | None,
        option(
            "FILE|PRESET|mjcf",
            "Controller that moved the joints to their targets: a TOML file, with a table "
            "[joint.NAME] for a joint that differs; or xl330, sts3215, unitree, mit; or mjcf, the "
            "position servos of the MJCF. Required if the logs contain target and position only.",
        ),
    ] = None

    @property
    def files(self) -> list[Path]:
        """The file that an option names."""
        return [Path(self.controller)] if self.controller else []

    @property
    def poses(self) -> dict[str, float | list[float]]:
        """Fixed positions by joint; ModelError if one is not JOINT=VALUE, or one joint twice."""
        found: dict[str, float | list[float]] = {}
        fix = "write JOINT=VALUE in rad or m, e.g. shoulder=0.3"
        for name, value in by_name("--fixed", self.fixed or [], fix).items():
            try:
                numbers = [float(x) for x in value.split(",")]
            except ValueError:
                raise ModelError(f"--fixed {name}={value}: {fix}") from None
            found[name] = numbers if len(numbers) > 1 else numbers[0]
        return found

    def reader(self, paths: "LogPaths") -> "Callable[[str | Path, str], JointLog]":
        """A function that reads a joint, or "" for the only one, of a log; LogError: bad option."""
        from frictionjoint.measured.readers import read_log
        from frictionjoint.measured.several_files import read_joined
        from frictionjoint.measured.table import ReadOptions
        from frictionjoint.measured.units import check_units

        fix = "write QUANTITY=UNIT, e.g. position=deg"
        units, columns = by_name("--unit", self.unit or [], fix), columns_of(self.column)
        check_units(units)

        how = ReadOptions(columns, tuple(self.signal or ()), self.wrap, units, self.drop_nan)

        def read(path: str | Path, joint: str) -> "JointLog":
            files, name = paths.joined.get(Path(path)), joint or None
            log = read_joined(files, name, how) if files else read_log(path, name, **vars(how))
            return log if self.gain is None else log.with_gain(self.gain)

        return read


NO_OPTIONS = LogOptions()
_TYPES = inspect.get_annotations(LogOptions)
_OPTIONAL = ("gain", "signal", "fixed", "controller")


def reads_logs(*also: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of `LogOptions` in place of its parameter ``options``, of those
    that not every command has (`_OPTIONAL`) the named ones."""
    names = [name for name in _TYPES if name not in _OPTIONAL or name in also]
    kind = inspect.Parameter.KEYWORD_ONLY
    own = [
        inspect.Parameter(name, kind, default=getattr(NO_OPTIONS, name), annotation=_TYPES[name])
        for name in names
    ]

    def with_options(command: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(command)
        def run(**given: Any) -> None:
            command(**given | {"options": LogOptions(**{name: given.pop(name) for name in names})})

        shown: list[inspect.Parameter] = []
        for parameter in inspect.signature(command).parameters.values():
            shown += own if parameter.name == "options" else [parameter.replace(kind=kind)]
        run.__signature__ = inspect.Signature(shown)  # type: ignore[attr-defined]
        run.__annotations__ = {x.name: x.annotation for x in shown}
        return run

    return with_options


@dataclass(frozen=True)
class LogPaths:
    """Logs to fit and to hold out, the fraction of each to hold out at its end, and by the path
    that stands for it the files of a log that has one per signal."""

    logs: list[Path]
    kept: list[Path]
    fraction: float | None
    joined: dict[Path, list[Path]]

    @property
    def files(self) -> list[Path]:
        return [*self.logs, *self.kept, *(x for own in self.joined.values() for x in own)]


def log_paths(logs: list[Path], held_out: list[str], join: bool = False) -> LogPaths:
    """The logs in folders and data sets; those held out, by path or one fraction of each, are not
    fitted. LogError if a folder contains none, one is both fitted and held out, or two fractions
    are given."""
    from frictionjoint.measured.readers import each_log
    from frictionjoint.measured.table import TABLES, is_text

    joined: dict[Path, list[Path]] = {}

    def found(paths: list[Path], held_out: list[Path]) -> list[Path]:
        if not join:
            return each_log(paths, held_out)
        folders = [path for path in paths if path.is_dir()]
        loose = [path for path in paths if not path.is_dir()]
        for folder in folders:
            inside = sorted(folder.iterdir())
            tables = [x for x in inside if x.suffix.lower() in TABLES]
            joined[folder] = tables or list(filter(is_text, inside))
        if loose:
            joined[loose[0]] = loose
        return folders + loose[:1]

    fractions = [x for x in map(_number, held_out) if x is not None]
    if len(fractions) > 1:
        raise LogError("--held-out: give one fraction at most")
    kept = found([Path(text) for text in held_out if _number(text) is None], [])
    fitted = found(logs, kept)
    held = {path.resolve() for path in kept}
    if same := [path for path in fitted if path.resolve() in held]:
        raise LogError(f"{same[0]} is both fitted and held out: give it once")
    return LogPaths(fitted, kept, fractions[0] if fractions else None, joined)


def columns_of(column: list[str] | None) -> dict[str, str]:
    """The file's column names by ours, from texts OURS=THEIRS; errors as those of `by_name`."""
    return by_name("--column", column or [], "write ours=theirs, e.g. time_s=t")


def by_name(option: str, texts: list[str], fix: str) -> dict[str, str]:
    """Values by name, from an option's texts; FrictionJointError: see `named`, or a name twice."""
    found: dict[str, str] = {}
    for name, value in (named(option, text, fix) for text in texts):
        if name in found:
            raise FrictionJointError(f"{option} {name} is given twice: keep one")
        found[name] = value
    return found


def named(option: str, text: str, fix: str) -> tuple[str, str]:
    """Both sides of an option's text NAME=VALUE; FrictionJointError, with the fix: no such text."""
    name, _, value = text.partition("=")
    if not (name and value):
        raise FrictionJointError(f"{option} {text}: {fix}")
    return name, value


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
