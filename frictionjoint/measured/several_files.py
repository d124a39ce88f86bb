"""A log of several files with one signal each, as written by oscilloscopes and data loggers.

Each file has a column of times and one or more columns of values. A value has the name of its
column, or of its file if columns of several files have the same name. The log uses the times of
the position; other signals are interpolated to them, and a target is held until the next one.

Where only one file holds times, or a sample rate is given, the rows of all files belong together.
Such files often hold a matrix, whose columns are ``q[0]``, ``q[1]``, ... by the name of the array
or, without one, of the file.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.columns import (
    check_names,
    choose,
    choose_signals,
    joint_of,
    joints_in,
    sample_rate,
)
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import column_names, load_columns, log_of
from frictionjoint.measured.units import converted
from frictionjoint.measured.validate import check_finite, check_lengths, check_time

_TIME = re.compile(r"(time|times|t|timestamp|stamp)[ _]?([\[(]?(s|sec|ms|us|ns)[\])]?)?", re.I)
_HELD = ("target_rad", "target_m", "torque_enabled")


def read_joined(
    files: Sequence[Path],
    joint: str | None = None,
    columns: Mapping[str, str] | None = None,
    signals: Iterable[str] = (),
    wrap: float | None = None,
    units: Mapping[str, str] | None = None,
) -> JointLog:
    """Read one joint from files with one signal each.

    Args:
        files: two or more tables. columns: our column name -> the signal's.
        joint, signals, wrap, units: see `read_log`.
    Returns:
        the log, over the time that all signals cover, named like the folder of the files.
    Raises:
        LogError: a file has no times, signals do not overlap, or see `read_log`.
    """
    if len(files) < 2:
        raise LogError(f"--join: {len(files)} file, give one file per signal, or their folder")
    source = files[0].parent / (files[0].parent.name or files[0].stem)
    mapping = dict(columns or {})
    clock = mapping.pop("time_s", None)
    if sample_rate(clock or "") or sum(bool(_times(file, clock)) for file in files) == 1:
        return _read_rows(files, joint, mapping, clock, signals, wrap, units)
    tables = {file: _values(file, clock) for file in files}
    places: dict[str, tuple[Path, str]] = {}
    for file, (_, values) in tables.items():
        for value in values:
            alone = sum(value in others for _, others in tables.values()) == 1
            # a header of several files' is no name: "value"
            ours = alone and (value in mapping.values() or not _is_plain(value))
            name = value if ours or len(values) > 1 else file.stem
            if name in places:
                raise LogError(f"{file.name}: {name!r} is in two files: rename a column or a file")
            places[name] = file, value
    table = check_names(source.name, list(places), mapping) | {"time_s": "time_s"}
    joint = joint_of(source.name, table, joint)
    wanted = choose(source.name, table, joint)
    wanted.pop("time_s")
    more = choose_signals(source.name, table, joint, signals, wanted.values())
    read = {
        ours: _signal(*places[theirs], tables[places[theirs][0]][0], units or {})
        for ours, theirs in (wanted | more).items()
    }
    position = next(read[name] for name in ("position_rad", "position_m") if name in read)
    begin = max(float(time[0]) for time, _ in read.values())
    end = min(float(time[-1]) for time, _ in read.values())
    time = position[0][(position[0] >= begin) & (position[0] <= end)]
    if len(time) < 2:
        raise LogError(f"{source.name}: the files' times do not overlap: do they use one clock?")
    on_time = {name: _at(time, *track, name in _HELD) for name, track in read.items()}
    data = {"time_s": time} | {name: on_time[name] for name in wanted}
    further = {name: on_time[name] for name in more}
    prefix = f"{joint}." if joints_in(table) else ""
    rest = {k: v for k, v in (units or {}).items() if k.rpartition(".")[2] != "time"}
    log = log_of(source, joint, data, prefix, further, wrap, rest)
    note = f"{log.name}: joined from {len(files)} files at the times of the position."
    return replace(log, notes=(note, *log.notes))


def _read_rows(
    files: Sequence[Path],
    joint: str | None,
    mapping: Mapping[str, str],
    clock: str | None,
    signals: Iterable[str],
    wrap: float | None,
    units: Mapping[str, str] | None,
) -> JointLog:
    """The log of files whose rows belong together."""
    source = files[0].parent / (files[0].parent.name or files[0].stem)
    places: dict[str, tuple[Path, str]] = {}
    for file in files:
        # the parts of its matrices that are asked for
        names = column_names(file, {x: x for x in mapping.values()})
        for name in names:
            bare = name.isdecimal()
            called = f"{file.stem}[{int(name) - 1}]" if bare and len(names) > 1 else name
            called = file.stem if called.isdecimal() else called
            if called in places:
                raise LogError(
                    f"{file.name}: {called!r} is in two files: rename an array or a file"
                )
            places[called] = file, name
    rate = sample_rate(clock or "")
    owner = None if rate else next(file for file in files if _times(file, clock))
    table = check_names(source.name, list(places), dict(mapping)) | {"time_s": "time_s"}
    joint = joint_of(source.name, table, joint)
    wanted = choose(source.name, table, joint)
    wanted.pop("time_s")
    further = choose_signals(source.name, table, joint, signals, wanted.values())
    read = {}
    for ours, theirs in (wanted | further).items():
        file, name = places[theirs]
        read[ours] = load_columns(file, [name], "")[name]
    if owner is None:
        time = np.arange(len(next(iter(read.values())))) / (rate or 1.0)
    else:
        stamp = _times(owner, clock)[0]
        time = load_columns(owner, [stamp], stamp)[stamp]
    check_lengths(source.name, {"time_s": time, **read})
    data = {"time_s": time} | {name: read[name] for name in wanted}
    prefix = f"{joint}." if joints_in(table) else ""
    more = {name: read[name] for name in further}
    log = log_of(source, joint, data, prefix, more, wrap, units)
    note = f"{log.name}: {len(files)} files, whose rows belong together."
    return replace(log, notes=(note, *log.notes))


def _times(file: Path, clock: str | None) -> list[str]:
    """Columns of a file that can be its times; a file of one such column is named by its file."""
    names = column_names(file)
    own = [n for n in names if n == clock or n == "time_s"]
    if len(names) == 1 and names[0].isdecimal() and file.stem == clock:
        own = names
    return own or ([] if clock else [n for n in names if _TIME.fullmatch(n.strip())])


def _is_plain(name: str) -> bool:
    """Whether the header of a column says nothing about its content."""
    return name.strip().lower() in ("value", "values", "data", "y", "signal", "")


def _values(file: Path, clock: str | None) -> tuple[str, list[str]]:
    """Name of the column of times of a file, and those of its values."""
    names = column_names(file)
    times = _times(file, clock) or _times(file, None)
    if len(times) != 1 or len(names) < 2:
        raise LogError(
            f"{file.name}: no column of times among {', '.join(names)}: name it with --column "
            "time_s=NAME"
        )
    return times[0], [name for name in names if name != times[0]]


def _signal(file: Path, value: str, clock: str, units: Mapping[str, str]) -> tuple[Array, Array]:
    """Times, s, and values of a file."""
    raw = load_columns(file, [clock, value], clock)
    time = converted(file.name, "time_s", raw[clock], units)
    check_lengths(file.name, {"time_s": time, value: raw[value]})
    for name, x in ((clock, time), (value, raw[value])):
        check_finite(file.name, name, x, lambda i: i + 2)
    check_time(file.name, time, lambda i: i + 2)
    return time, raw[value]


def _at(time: Array, given: Array, x: Array, held: bool) -> Array:
    if held:
        return np.asarray(x[np.searchsorted(given, time, side="right") - 1])
    return np.interp(time, given, x)
