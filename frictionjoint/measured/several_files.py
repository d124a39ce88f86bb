"""A log of several files with one signal each, as written by oscilloscopes and data loggers.

Each file has a column of times and one or more columns of values. A value has the name of its
column, or of its file if columns of several files have the same name. The log uses the times of
the position; other signals are interpolated to them, and a target is held until the next one.

Where only one file holds times, or a sample rate is given, the rows of all files belong together.
Such files often hold a matrix, whose columns are ``q[0]``, ``q[1]``, ... by the name of the array
or, without one, of the file.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.columns import check_names, choose, sample_rate
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import DEFAULT, ReadOptions, column_names, load_columns, log_of
from frictionjoint.measured.units import converted
from frictionjoint.measured.validate import check_finite, check_lengths, check_time

_TIME = re.compile(r"(time|times|t|timestamp|stamp)[ _]?([\[(]?(s|sec|ms|us|ns)[\])]?)?", re.I)
# headers that say nothing about the content of their column
_PLAIN = ("value", "values", "data", "y", "signal", "")
_HELD = ("target_rad", "target_m", "torque_enabled")


def read_joined(
    files: Sequence[Path], joint: str | None = None, how: ReadOptions = DEFAULT
) -> JointLog:
    """Read one joint from files with one signal each.

    Args:
        files: two or more tables. joint: see `read_log`.
        how: all but drop_nan; columns are our column name -> the signal's.
    Returns:
        the log, over the time that all signals cover, named like the folder of the files.
    Raises:
        LogError: a file has no times, signals do not overlap, or see `read_log`.
    """
    if len(files) < 2:
        raise LogError(f"--join: {len(files)} file, give one file per signal, or their folder")
    source = files[0].parent / (files[0].parent.name or files[0].stem)
    mapping = dict(how.columns)
    clock = mapping.pop("time_s", None)
    rate = sample_rate(clock or "")
    together = bool(rate) or sum(bool(_times(f, clock)) for f in files) == 1
    clocks = {} if together else {file: _clock(file, clock) for file in files}
    places = _rows_by_name(files, mapping) if together else _signals_by_name(clocks, mapping)
    table = check_names(source.name, list(places), mapping) | {"time_s": "time_s"}
    joint, prefix, wanted, more, _ = choose(source.name, table, joint, how.signals)
    wanted.pop("time_s")
    which = {ours: places[theirs] for ours, theirs in (wanted | more).items()}
    if together:
        found = {ours: load_columns(file, [name], "")[name] for ours, (file, name) in which.items()}
        if rate:
            time = np.arange(len(next(iter(found.values())))) / rate
        else:
            owner, stamp = next((f, names[0]) for f in files if (names := _times(f, clock)))
            time = load_columns(owner, [stamp], stamp)[stamp]
        found = {"time_s": time} | found
        check_lengths(source.name, found)
        note = f"{len(files)} files, whose rows belong together."
    else:
        tracks = {ours: _signal(*x, clocks[x[0]], how.units) for ours, x in which.items()}
        found = _at_position(source.name, tracks)
        units = {k: v for k, v in how.units.items() if k.rpartition(".")[2] != "time"}
        how = replace(how, units=units)
        note = f"joined from {len(files)} files at the times of the position."
    data = {name: found[name] for name in ("time_s", *wanted)}
    how, signals = replace(how, drop_nan=False), {name: found[name] for name in more}
    log = log_of(source, joint, data, how, prefix, signals)
    return replace(log, notes=(f"{log.name}: {note}", *log.notes))


def _signals_by_name(
    clocks: Mapping[Path, str], mapping: Mapping[str, str]
) -> dict[str, tuple[Path, str]]:
    """File and column of each signal of files with times of their own, by the signal's name."""
    tables = {file: [x for x in column_names(file) if x != own] for file, own in clocks.items()}
    places: dict[str, tuple[Path, str]] = {}
    for file, values in tables.items():
        for value in values:
            alone = sum(value in others for others in tables.values()) == 1
            # a header of several files' is no name: "value"
            ours = alone and (value in mapping.values() or value.strip().lower() not in _PLAIN)
            name = value if ours or len(values) > 1 else file.stem
            if name in places:
                raise LogError(f"{file.name}: {name!r} is in two files: rename a column or a file")
            places[name] = file, value
    return places


def _rows_by_name(files: Sequence[Path], mapping: Mapping[str, str]) -> dict[str, tuple[Path, str]]:
    """File and column of each signal of files whose rows belong together, by its name."""
    places: dict[str, tuple[Path, str]] = {}
    for file in files:
        # the parts of its matrices that are asked for
        names = column_names(file, {x: x for x in mapping.values()})
        for name in names:
            bare = name.isdecimal()
            called = f"{file.stem}[{int(name) - 1}]" if bare and len(names) > 1 else name
            called = file.stem if called.isdecimal() else called
            if called in places:
                fix = "rename an array or a file"
                raise LogError(f"{file.name}: {called!r} is in two files: {fix}")
            places[called] = file, name
    return places


def _at_position(source: str, tracks: Mapping[str, tuple[Array, Array]]) -> dict[str, Array]:
    """Signals with times of their own, at the times of the position that all of them cover."""
    position = next(tracks[name] for name in ("position_rad", "position_m") if name in tracks)
    begin = max(float(time[0]) for time, _ in tracks.values())
    end = min(float(time[-1]) for time, _ in tracks.values())
    time = position[0][(position[0] >= begin) & (position[0] <= end)]
    if len(time) < 2:
        raise LogError(f"{source}: the files' times do not overlap: do they use one clock?")
    found = {"time_s": time}
    for name, (given, x) in tracks.items():
        held = np.searchsorted(given, time, side="right") - 1 if name in _HELD else None
        found[name] = np.interp(time, given, x) if held is None else x[held]
    return found


def _times(file: Path, clock: str | None) -> list[str]:
    """Columns of a file that can be its times; a file of one such column is named by its file."""
    names = column_names(file)
    own = [n for n in names if n == clock or n == "time_s"]
    if len(names) == 1 and names[0].isdecimal() and file.stem == clock:
        own = names
    return own or ([] if clock else [n for n in names if _TIME.fullmatch(n.strip())])


def _clock(file: Path, clock: str | None) -> str:
    """Name of the column of times of a file."""
    names = column_names(file)
    times = _times(file, clock) or _times(file, None)
    if len(times) != 1 or len(names) < 2:
        first = names[0] if names[0].isdecimal() else "NAME"
        what = f"no column of times among {', '.join(names)}"
        raise LogError(f"{file.name}: {what}: name it with --column time_s={first}")
    return times[0]


def _signal(file: Path, value: str, clock: str, units: Mapping[str, str]) -> tuple[Array, Array]:
    """Times, s, and values of a file."""
    raw = load_columns(file, [clock, value], clock)
    time = converted(file.name, "time_s", raw[clock], units)
    check_lengths(file.name, {"time_s": time, value: raw[value]})
    for name, x in ((clock, time), (value, raw[value])):
        check_finite(file.name, name, x, lambda i: i + 2)
    check_time(file.name, time, lambda i: i + 2)
    return time, raw[value]
