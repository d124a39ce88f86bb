"""Read a log of any format; the format follows from the file's name and content.

The package's own format is a table with the column names of `columns`. A folder of logs stands for
all of them, see `log_files`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import NoneType
from typing import Any, TypeVar

from frictionjoint.errors import LogError
from frictionjoint.measured import lerobot, public_logs
from frictionjoint.measured.arguments import expect
from frictionjoint.measured.bam_json import read_bam_json
from frictionjoint.measured.columns import check_names, driven_joints
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.rollout import is_rollout, joints_of_rollout, read_rollout
from frictionjoint.measured.rosbag import SUFFIXES, is_bag, joints_of_bag, read_rosbag
from frictionjoint.measured.table import TABLES, ReadOptions, column_names, is_text, read_table
from frictionjoint.measured.units import check_units

# files of a report that could be logs by their names
_RESULTS = ("report.json", "evaluation.json", "next_trajectory.csv")
_KINDS = (*TABLES, *SUFFIXES, ".pt", ".json", ".npy")
_Log = TypeVar("_Log", bound=JointLog | str | Path)


def read_log(
    path: str | Path,
    joint: str | None = None,
    columns: Mapping[str, str] | None = None,
    signals: Iterable[str] = (),
    wrap: float | None = None,
    units: Mapping[str, str] | None = None,
    drop_nan: bool = False,
) -> JointLog:
    """Read one joint of a log.

    Args:
        path: .csv, .tsv or other text, .parquet, .npz, .mat, .db3, .mcap, .bag, .pt, BAM's and
            K-Scale's .json, the ODrive's .npy, or the folder of a ROS 2 bag, of a LeRobot data set
            (``FOLDER#3``: episode 3), of the Panda's or of the TX40's log.
        joint: its name, if the log contains several.
        columns: our column name -> the file's, for tables with names of their own, for instance
            ``{"time_s": "t", "position_rad": "q"}``. A file without a header has its columns
            numbered, from ``"1"``; ``{"time_s": "500Hz"}`` is a sample rate. Without a position
            the velocity is integrated. For values see `units`. What a bag, a data set or a rollout
            takes instead stands with its reader.
        signals: columns of a table that friction may depend on, as a normal load.
        wrap: range that positions wrap at, rad (m); 2 pi, 4 pi, 8 pi and 25 rad are noticed.
        units: unit by quantity, for quantities that are not in SI units, for instance
            ``{"position": "deg", "time": "ms"}`` or ``{"position": "counts:4096"}``, see `units`.
        drop_nan: leave out rows of a table with an empty cell or NaN; a note says how many.
    Returns:
        the log; its notes state what was repaired. Gaps stay in it.
    Raises:
        LogError: one line that names the file, the row or column, and the fix.
        TypeError: not a path, or not names.
    """
    expect(path, (str, Path), "log", "give the path of a file, or a JointLog")
    expect(joint, (str, NoneType), "joint", "give its name in the log")
    expect(columns, (Mapping, NoneType), "columns", 'give names by name, {"time_s": "t"}')
    expect(units, (Mapping, NoneType), "units", 'give units by quantity, {"position": "deg"}')
    path = Path(path)
    how = ReadOptions(dict(columns or {}), tuple(signals), wrap, dict(units or {}), drop_nan)
    check_units(how.units)
    kind, special = path.suffix.lower(), _of_joints(path, how.columns)
    table = not special and path.is_file() and _is_table(path)
    # named columns ask for the table: the known variables of EMPS are read without a name
    emps = table and kind == ".mat" and not columns and public_logs.is_emps(column_names(path))
    if table and not emps:
        return read_table(path, joint, how)
    if not special and not table and not path.is_dir() and kind not in (".json", ".npy"):
        raise LogError(f"{path.name}: unknown kind of log, give one of {', '.join(_KINDS)}")
    more = {} if special else {"--column": how.columns, "--unit": how.units}
    ignored = {**more, "--signal": how.signals, "--wrap": how.wrap, "--drop-nan": how.drop_nan}
    if emps and (given := [name for name, value in ignored.items() if value]):
        fix = "name its columns too, e.g. --column position_m=qm, and it is read as a table"
        raise LogError(f"{path.name}: a log of EMPS in its own format takes no {given[0]}: {fix}")
    if any(ignored.values()):
        *most, last = ignored
        which = f"{', '.join(most)} and {last}"
        raise LogError(f"{path.name}: {which} apply only to {', '.join(TABLES)}")
    if emps:
        return public_logs.read_emps(path)
    if special:
        return special[0](path, joint, how)
    if path.is_dir():
        return public_logs.read_folder(path, joint)
    return read_bam_json(path, joint) if kind == ".json" else public_logs.read_odrive(path)


def _of_joints(
    path: Path, columns: Mapping[str, str] | None
) -> tuple[Callable[..., JointLog], Callable[..., list[str]]] | None:
    """Readers of a log of all joints of a robot and of their names; LogError: there is no log."""
    if lerobot.is_lerobot(path):
        return lerobot.read_lerobot, lerobot.joints_of_lerobot
    if not path.exists():
        raise LogError(f"{path}: no such log, check the path")
    if is_bag(path):
        return read_rosbag, joints_of_bag
    return (read_rollout, joints_of_rollout) if is_rollout(path, columns) else None


def _is_table(path: Path) -> bool:
    """Whether a file is a table by its ending or, if no format has that ending, by its text."""
    kind = path.suffix.lower()
    return kind in TABLES or (kind not in _KINDS and is_text(path))


def log_files(path: str | Path) -> list[Path]:
    """The logs that a path names: itself, all episodes of a data set (``FOLDER#0-7``: some), or all
    logs of a folder; LogError if it has none."""
    path = Path(path)
    if lerobot.is_lerobot(path):
        numbers = lerobot.episodes_of(path)
        folder, _ = lerobot.episode_of(path)
        whole = folder == path and len(numbers) == 1
        return [path] if whole else [folder.with_name(f"{folder.name}#{i}") for i in numbers]
    if not path.is_dir() or is_bag(path) or public_logs.joints_of_folder(path):
        return [path]
    entries = (x for x in path.iterdir() if x.name not in _RESULTS)
    found = sorted(x for x in entries if x.suffix.lower() in _KINDS or is_bag(x))
    if not found:
        raise LogError(f"{path}: a folder without a log: name one of {', '.join(_KINDS)}")
    return found


def each_log(
    logs: Sequence[_Log], held_out: Sequence[JointLog | str | Path] = ()
) -> list[_Log | Path]:
    """Logs one by one: those of a folder without held-out ones; LogError if a folder has none."""
    kept = {Path(x) for x in held_out if not isinstance(x, JointLog)}
    found: list[_Log | Path] = []
    for log in logs:
        if isinstance(log, JointLog) or (files := log_files(log)) == [Path(log)]:
            found.append(log)
        else:
            found += [x for x in files if x not in kept]
    return found


def joints_with_drive(path: str | Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Joints with a logged drive; none if no column names a joint. Arguments as of `read_log`."""
    path = Path(path)
    if special := _of_joints(path, columns):
        return special[1](path, columns)
    if path.is_dir():
        return list(public_logs.joints_of_folder(path))
    if not _is_table(path):
        return []
    names = column_names(path, columns)
    return driven_joints(check_names(path.name, names, dict(columns or {})))


def require_logs(logs: Any, held_out: Any) -> None:
    """Check the arguments for logs and held-out logs or their fraction; TypeError: one log instead
    of a list, or not a log; LogError: there is no log to fit."""
    _require_list("logs", logs)
    if not isinstance(held_out, int | float):
        _require_list("held_out", held_out)
    if not logs:
        raise LogError("no log to fit: give at least one that is not held out")


def _require_list(name: str, logs: Any) -> None:
    if isinstance(logs, JointLog | str | Path):
        raise TypeError(f"{name} is one log: give a list, [log]")
    if isinstance(logs, Mapping) or not hasattr(logs, "__len__"):
        kind = type(logs).__name__
        raise TypeError(f"{name} is of type {kind}: give a list of paths or of JointLog")
    for log in logs:
        expect(log, (JointLog, str, Path), name, "a log is a path or a JointLog")
