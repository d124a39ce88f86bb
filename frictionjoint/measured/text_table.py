"""Text tables: header, columns, and the line of a bad cell.

The separator is a comma; a header without commas may use semicolons, tabs or single blanks, and
then numbers may use a decimal comma. The header is the first line that names a column for each cell
of the samples; lines above it, from a recorder, are skipped with a note. Lines that begin with #
are comments; the last one is the header if only numbers follow, as numpy writes it. One line of
units may follow the header. Columns without a name are dropped. Blank lines are no samples but
count as lines in messages. A column of dates and times (ISO 8601) is read as seconds since the
first.
"""

import csv
import math
import re
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line
from frictionjoint.measured.text_layout import MOMENT, Layout, layout_of

ENDINGS = (".csv", ".tsv", ".txt", ".dat")
# a date with a time in another order than that of ISO 8601
_DATE = re.compile(r"\s*\d{1,4}[./-]\d{1,2}[./-]\d{1,4}[T ]\s*\d{1,2}:\d\d")
# what programs write where a number is missing
_MISSING = {"", "na", "n/a", "#n/a", "#na", "null", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan"}


def read_columns(path: Path, names: list[str], time: str | None = None) -> dict[str, Array]:
    """Some columns of a file, each of shape (n,); that of `time` may contain dates and times.

    Lines are read in batches: 8 bytes per number in the result, at most 16 while reading.

    Raises:
        LogError: with the line number, for a cell that is no number or a line of another width.
    """
    layout = layout_of(path)
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in names}
    at = [layout.columns.index(name) for name in names]
    for first, lines in _batches(path, layout):
        table = _only_numbers(lines, layout)
        if table is not None:
            for name, i in zip(names, at, strict=True):
                parts[name].append(table[:, i].copy())
            continue
        rows = _rows(path, layout, first, lines)
        if not rows:
            continue
        columns = list(zip(*(cells for _, cells in rows), strict=True))
        for name, i in zip(names, at, strict=True):
            zoned = layout.zoned.get(name) if name == time else None
            try:
                parts[name].append(_values(columns[i], layout.point, zoned))
            except ValueError:
                fault = _fault(rows, name, i, layout.point, zoned)
                raise LogError(f"{path.name}, {fault}") from None
    return {name: _joined(parts.pop(name)) for name in names}


def _batches(path: Path, layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """Batches of lines that may be samples, and the number, from 1, of the first line of each."""
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        lines = islice(file, layout.before, None)
        number = layout.before + 1
        # read as text, so many rows at once
        while batch := list(islice(lines, 10_000)):
            yield number, batch
            number += len(batch)


def _only_numbers(lines: list[str], layout: Layout) -> Array | None:
    """Samples, (samples, columns), if all are numbers: several times faster than cell by cell."""
    if layout.point == "," or layout.zoned:
        return None
    samples = [line for line in lines if line.rstrip("\r\n")]
    if not samples:
        return np.empty((0, len(layout.columns)))
    try:
        table = np.loadtxt(samples, delimiter=layout.separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return table if table.shape[1] == len(layout.columns) else None


def _rows(path: Path, layout: Layout, first: int, lines: list[str]) -> list[tuple[int, list[str]]]:
    """Line number, from 1, and cells of each sample; blank lines are skipped."""
    reader = csv.reader(lines, delimiter=layout.separator)
    made, wide = [], len(layout.columns)
    try:
        for cells in reader:
            number = first + reader.line_num - 1
            if cells and len(cells) != wide:
                what = f"{len(cells)} cell{'s' * (len(cells) != 1)}, the header has {wide}"
                fix = "complete the row or leave it out"
                raise LogError(f"{path.name}, row {number}: {what}: {fix}")
            if cells:
                made.append((number, cells))
    except csv.Error as fault:
        number = first + reader.line_num - 1
        raise LogError(f"{path.name}, row {number}: {one_line(fault)}") from None
    return made


def _values(cells: Sequence[str], point: str, zoned: bool | None) -> NDArray[Any]:
    """Cells as numbers or, according to `zoned`, as dates; ValueError for other cells."""
    return _numbers(cells, point) if zoned is None else _moments(cells, zoned)


def _fault(
    rows: list[tuple[int, list[str]]], name: str, at: int, point: str, zoned: bool | None
) -> str:
    """Message with the first cell of a column that `_values` does not accept."""
    wanted = "number" if zoned is None else "date with a time, as that of the first row is"
    for number, cells in rows:
        try:
            _values([cells[at]], point, zoned)
        except ValueError:
            comma = point == "." and "," in cells[at]
            fix = "write decimal points" if comma else "correct it or leave the row out"
            fix = "write dates as 2026-01-31 12:00:00.5" if _DATE.match(cells[at]) else fix
            return f"row {number}, {name}: {cells[at][:40]!r} is not a {wanted}: {fix}"
    raise AssertionError(name)


def _numbers(cells: Sequence[str], point: str) -> Array:
    """Cells as numbers, NaN for an empty cell; ValueError for a cell that is not a number."""
    text = "".join(cells)
    if "_" in text or not text.isascii():  # which Python would take
        raise ValueError
    if point == ",":
        cells = [x.replace(",", ".") for x in cells]
    try:
        return np.array([float(x) if x else math.nan for x in cells])
    except ValueError:
        known = ("" if x.strip().lower() in _MISSING else x for x in cells)
        return np.array([float(x) if x else math.nan for x in known])


def _moments(cells: Sequence[str], zoned: bool) -> NDArray[np.datetime64]:
    """Dates with times as universal time, in nanoseconds; ValueError for other cells."""
    local, minutes = [], []
    for cell in map(str.strip, cells):
        found = MOMENT.fullmatch(cell)
        if cell and (not found or bool(found["zone"]) != zoned):
            raise ValueError
        zone = found["zone"] or "" if found else ""
        local.append(cell.removesuffix(zone) or "NaT")
        digits = zone.strip("Z+-").replace(":", "").ljust(4, "0")
        ahead = 60 * int(digits[:2]) + int(digits[2:])
        minutes.append(-ahead if zone.startswith("-") else ahead)
    moments: NDArray[np.datetime64] = np.array(local, "datetime64[ns]")
    return np.asarray(moments - np.array(minutes, "timedelta64[m]"))


def _joined(parts: list[NDArray[Any]]) -> Array:
    """One column; seconds since the first of its dates."""
    x: NDArray[Any] = np.concatenate(parts) if parts else np.empty(0)
    if np.issubdtype(x.dtype, np.datetime64):
        return np.asarray((x - x[:1]) / np.timedelta64(1, "s"))
    return x


def line_of(path: Path, sample: int) -> int:
    """Line number, from 1, of a sample; blank lines between are counted, not sampled."""
    layout = layout_of(path)
    left = sample
    for first, lines in _batches(path, layout):
        for number, line in enumerate(lines, start=first):
            left -= bool(line.rstrip("\r\n"))
            if left < 0:
                return number
    return layout.before + sample + 1
