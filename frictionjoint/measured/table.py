"""Logs in tables: CSV and other text, Parquet, npz, MATLAB and HDF5 files, a column per quantity.

Memory: only the columns of the chosen joint and the positions and velocities of the others are
read, 8 bytes per row each; at most three times that is used while reading. Measured: four columns
of 10 million rows take 320 MB, with a peak of 930 MB (CSV) or 770 MB (Parquet).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured import arrays, repairs, text_table, validate
from frictionjoint.measured.columns import BOTH, HINGE, SLIDE, check_names, choose, sample_rate
from frictionjoint.measured.headerless import bare_columns, bare_names, is_bare
from frictionjoint.measured.log import FEWEST_ROWS, JointLog
from frictionjoint.measured.text_layout import layout_of
from frictionjoint.measured.units import converted, is_si, quantity_of, unit_of

TABLES = (*text_table.ENDINGS, ".parquet", ".npz", ".mat", *arrays.HDF5_ENDINGS)
_Arrays = tuple[Callable[[Path], list[str]], Callable[[Path, list[str]], dict[str, Array]]]
_ARRAYS: dict[str, _Arrays] = {
    ".npz": (arrays.npz_names, arrays.npz_columns),
    ".mat": (arrays.mat_names, arrays.mat_columns),
    **dict.fromkeys(arrays.HDF5_ENDINGS, (arrays.hdf5_names, arrays.hdf5_columns)),
}
_SHARED = ("time_s", "temperature_c", "supply_v", "torque_enabled")
# of a log, in the order of the columns of a hinge or slide, and of both
_ALSO = ("voltage", "current", "supply", "temperature", "motor_position")
_FIELDS = ("position", "velocity", "torque", "target", *_ALSO)


@dataclass(frozen=True)
class ReadOptions:
    """How to read a log; for the attributes see the arguments of `read_log`."""

    columns: dict[str, str] = field(default_factory=dict)
    signals: tuple[str, ...] = ()
    wrap: float | None = None
    units: dict[str, str] = field(default_factory=dict)
    drop_nan: bool = False


DEFAULT = ReadOptions()


def read_table(path: Path, joint: str | None, how: ReadOptions) -> JointLog:
    """Read one joint from a table; errors as those of `read_log`."""
    table = check_names(path.name, column_names(path, how.columns), how.columns)
    joint, prefix, wanted, more, figures = choose(path.name, table, joint, how.signals)
    layout = layout_of(path) if _has_header(path) else None
    units = layout.units if layout else {}
    for ours, theirs in wanted.items():
        cell = units.get(theirs, "")
        if layout and unit_of(ours, how.units) is None and not is_si(ours, cell):
            place = f"{path.name}, row {layout.before}, {theirs}: the row of units says {cell!r}"
            fix = f"give --unit {quantity_of(ours)}=UNIT"
            raise LogError(f"{place}, which is not the unit of {ours}: {fix}")
    clock = wanted["time_s"]
    rate = None if clock in table else sample_rate(clock)
    if rate:
        wanted.pop("time_s")
    names = sorted({*wanted.values(), *more.values(), *figures.values()})
    raw = load_columns(path, names, clock)
    data = {ours: raw[theirs] for ours, theirs in wanted.items()}
    if rate:
        data["time_s"] = np.arange(len(next(iter(data.values())))) / rate
    further = {name: raw[theirs] for name, theirs in more.items()}
    log = log_of(path, joint, data, how, prefix, further)
    if layout and layout.note:
        log = replace(log, notes=(f"{path.stem}: {layout.note}", *log.notes))
    # one that changes on the way is no figure of the log
    same = {name: raw[theirs] for name, theirs in figures.items() if np.ptp(raw[theirs]) == 0.0}
    return replace(log, metadata={name: float(x[0]) for name, x in same.items()})


def log_of(
    path: Path,
    joint: str,
    data: dict[str, Array],
    how: ReadOptions = DEFAULT,
    prefix: str = "",
    signals: Mapping[str, Array] | None = None,
) -> JointLog:
    """A log from arrays with our column names; wrapped positions and repeated rows are repaired.

    Args:
        data: shape (n,) each; names of other joints' motion carry their prefix. In addition to the
            names of `columns`, ``torque_enabled``: above 0.5 while the drive is on.
        how: wrap, units and drop_nan. prefix: of the joint's own columns in the file, for messages.
        signals: further quantities by name.
    Raises:
        LogError: see `validate` and `units`.
    """
    if how.units:
        own_names = {k: k if k in _SHARED or "." in k else f"{joint}.{k}" for k in data}
        data = {k: converted(path.name, own_names[k], x, how.units) for k, x in data.items()}
    text, kept = _has_header(path), None
    signals = signals or {}
    unprefixed, data = {*_SHARED, *signals}, {**data, **signals}
    dropped: tuple[str, ...] = ()

    def shown(columns: dict[str, Array]) -> dict[str, Array]:
        return {k if k in unprefixed or "." in k else prefix + k: x for k, x in columns.items()}

    if how.drop_nan:
        validate.check_lengths(path.name, shown(data))
        empty = np.logical_or.reduce([np.isnan(x) for x in data.values()])
        kept = np.flatnonzero(~empty)
        data = {name: x[kept] for name, x in data.items()}
        if len(kept) < FEWEST_ROWS <= len(empty):
            what = f"only {len(kept)} of {len(empty)} rows have no empty cell"
            fix = "put signals with different times in one file each, with --join, or interpolate"
            raise LogError(f"{path.name}: {what}: {fix} them")
        if empty.any():
            rows = f"{int(empty.sum())} of {len(empty)} rows with an empty cell or NaN"
            dropped = (f"{path.stem}: {rows} were left out.",)

    def row(i: int) -> int:
        """Number of a sample's row in the file, as an editor counts it."""
        place = i if kept is None else int(kept[i])
        return text_table.line_of(path, place) if text else place + 1

    data["time_s"], runs = repairs.with_one_clock(data["time_s"])
    validate.check_rows(path.name, shown(data), row)
    data, integrated = repairs.with_position(data)
    data, lone = repairs.without_lone_readings(data)
    data, notes = repairs.unwrapped(path.name, data, how.wrap)
    validate.check_columns(path.name, shown(data), row)
    own = {name: x for name, x in data.items() if "." not in name}
    validate.check_moves(path.name, shown(own))
    data, more = repairs.without_repeats(data)
    own = {name: x for name, x in data.items() if "." not in name}
    validate.check_leaps(path.name, shown(own))
    said = runs + integrated + lone + notes + more + repairs.drive_notes(own)
    notes = (*dropped, *(f"{path.stem}: {note}" for note in said))

    def others(quantity: str) -> dict[str, Array]:
        parts = ((key.rpartition("."), x) for key, x in data.items())
        return {other: x for (other, dot, unit), x in parts if dot and unit.startswith(quantity)}

    slide = "position_m" in data
    enabled = None if "torque_enabled" in signals else data.get("torque_enabled")
    columns = dict(zip(_FIELDS, (*(SLIDE if slide else HINGE), *BOTH), strict=True))
    fields: dict[str, Any] = {field: data.get(column) for field, column in columns.items()}
    return JointLog(
        name=path.stem,
        joint=joint,
        time=data["time_s"],
        **fields,
        torque_enabled=None if enabled is None else enabled > 0.5,
        slide=slide,
        other_positions=others("position"),
        other_velocities=others("velocity"),
        signals={name: data[name] for name in signals},
        notes=notes,
    )


def _has_header(path: Path) -> bool:
    """Whether a file is text with named columns."""
    return is_text(path) and not is_bare(path)


def is_text(path: Path) -> bool:
    """Whether a file is a text table: by its ending or, if that is not of a table, its content."""
    kind = path.suffix.lower()
    if kind in TABLES or not path.is_file():
        return kind in text_table.ENDINGS
    with path.open("rb") as file:
        return b"\0" not in file.read(4096)


def column_names(path: Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Names of a table's columns, without reading rows, and requested parts of its matrices."""
    if is_text(path):
        return bare_names(path) if is_bare(path) else layout_of(path).names
    if path.suffix.lower() == ".parquet":
        return arrays.parquet_names(path)
    reader = _arrays(path)
    if not reader:
        raise LogError(f"{path.name}: unknown kind of table, give one of {', '.join(TABLES)}")
    names = reader[0](path)
    asked = dict.fromkeys((columns or {}).values())
    return [*names, *(x for x in asked if x not in names and arrays.array_of(x) in names)]


def load_columns(path: Path, names: list[str], time: str) -> dict[str, Array]:
    """Only the requested columns, each of shape (n,); the time column may contain dates."""
    if is_text(path):
        if is_bare(path):
            return bare_columns(path, names)
        return text_table.read_columns(path, names, time)
    if reader := _arrays(path):
        return reader[1](path, names)
    return {name: arrays.parquet_column(path, name, name == time) for name in names}


def _arrays(path: Path) -> _Arrays | None:
    """Functions for the names and the columns of a file of arrays; None for other tables."""
    kind = path.suffix.lower()
    # MATLAB 7.3 writes HDF5
    return _ARRAYS.get(".h5" if kind == ".mat" and arrays.is_hdf5(path) else kind)
