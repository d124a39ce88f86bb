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
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line
from frictionjoint.measured.units import is_unit

ENDINGS = (".csv", ".tsv", ".txt", ".dat")
_LONGEST_HEADER = 1 << 20
_SEPARATORS = ",;\t "
# name of a column that has none
_UNNAMED = "(column {})"
# What is taken as a number or as an empty cell.
_NUMBER = re.compile(
    r"\s*([+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(inf(inity)?|nan))?\s*", re.I | re.A
)
# what programs write where a number is missing
_MISSING = {"", "na", "n/a", "#n/a", "#na", "null", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan"}
# A date with a time, and its difference to universal time.
_MOMENT = re.compile(
    r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d{1,9})?)?(Z|[+-]\d\d(:?\d\d)?)?\s*"
)
_ZONE = 3


class _Layout(NamedTuple):
    """Layout of a file.

    Attributes:
        names: of its columns, None for one without a name. separator: between cells.
        point: decimal separator. before: lines before the first that may be a sample.
        zoned: date columns, and whether they name their time zone. title: line number of the
            header. skipped: lines above it that are no comments.
        units: cell below each name, if there is a line of units.
    """

    names: list[str | None]
    separator: str
    point: str
    before: int
    zoned: dict[str, bool]
    title: int = 1
    skipped: int = 0
    units: tuple[str, ...] = ()

    @property
    def all_names(self) -> list[str]:
        """A name for every column."""
        return [x or _UNNAMED.format(i) for i, x in enumerate(self.names, start=1)]


def header(path: Path) -> list[str]:
    """Column names of a file.

    Raises:
        LogError: the file is empty or no text.
    """
    return [name for name in _layout(path).names if name is not None]


def units_row(path: Path) -> tuple[int, dict[str, str]]:
    """Line number of the line of units, and its cells by column name; none without such a line."""
    layout = _layout(path)
    pairs = zip(layout.names, layout.units, strict=False)
    return layout.before, {name: unit for name, unit in pairs if name is not None}


def notes(path: Path) -> tuple[str, ...]:
    """Notes on how the file was read."""
    layout = _layout(path)
    if layout.title <= 1 or not layout.skipped:
        return ()
    lines = "line 1" if layout.skipped == 1 else f"lines 1 to {layout.skipped}"
    return (f"{lines} skipped: the header with the column names is line {layout.title}.",)


def read_columns(path: Path, names: list[str], time: str | None = None) -> dict[str, Array]:
    """Some columns of a file, each of shape (n,).

    Lines are read in batches: 8 bytes per number in the result, at most 16 while reading.

    Args:
        time: the column that may contain dates and times.
    Raises:
        LogError: with the line number, for a cell that is no number or a line of another width.
    """
    layout = _layout(path)
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in names}
    at = [layout.all_names.index(name) for name in names]
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


def _batches(path: Path, layout: _Layout) -> Iterator[tuple[int, list[str]]]:
    """Batches of lines that may be samples, and the number, from 1, of the first line of each."""
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        lines = islice(file, layout.before, None)
        number = layout.before + 1
        # read as text, so many rows at once
        while batch := list(islice(lines, 10_000)):
            yield number, batch
            number += len(batch)


def _only_numbers(lines: list[str], layout: _Layout) -> Array | None:
    """Samples with a number in every cell, shape (samples, columns); None where there are others.

    Several times faster than cell by cell.
    """
    if layout.point == "," or layout.zoned:
        return None
    samples = [line for line in lines if line.rstrip("\r\n")]
    if not samples:
        return np.empty((0, len(layout.names)))
    try:
        table = np.loadtxt(samples, delimiter=layout.separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return table if table.shape[1] == len(layout.names) else None


def _rows(path: Path, layout: _Layout, first: int, lines: list[str]) -> list[tuple[int, list[str]]]:
    """Line number, from 1, and cells of each sample; blank lines are skipped."""
    reader = csv.reader(lines, delimiter=layout.separator)
    made, wide = [], len(layout.names)
    try:
        for cells in reader:
            number = first + reader.line_num - 1
            if cells and len(cells) != wide:
                raise LogError(
                    f"{path.name}, row {number}: {len(cells)} cells, the header has {wide}: "
                    "complete the row or leave it out"
                )
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
            return f"row {number}, {name}: {cells[at][:40]!r} is not a {wanted}"
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
        return np.array([_number(x) for x in cells])


def _number(cell: str) -> float:
    return math.nan if cell.strip().lower() in _MISSING else float(cell)


def _moments(cells: Sequence[str], zoned: bool) -> NDArray[np.datetime64]:
    """Dates with times as universal time, in nanoseconds; ValueError for other cells."""
    local, minutes = [], []
    for cell in map(str.strip, cells):
        found = _MOMENT.fullmatch(cell)
        if cell and (not found or bool(found[_ZONE]) != zoned):
            raise ValueError
        zone = found[_ZONE] or "" if found else ""
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
    layout = _layout(path)
    left = sample
    for first, lines in _batches(path, layout):
        for number, line in enumerate(lines, start=first):
            left -= bool(line.rstrip("\r\n"))
            if left < 0:
                return number
    return layout.before + sample + 1


def _layout(path: Path) -> _Layout:
    try:
        with path.open(encoding="utf-8-sig") as file:
            return _layout_of(path.name, iter(lambda: file.readline(_LONGEST_HEADER), ""))
    except UnicodeDecodeError:
        raise LogError(f"{path.name}: not text in UTF-8, save it as UTF-8") from None
    except OSError as error:
        raise LogError(f"{path.name}: cannot be read: {error.strerror}") from None


def _layout_of(name: str, lines: Iterator[str]) -> _Layout:
    """Layout of a file from its first lines."""
    # header and first samples are within 60 lines
    some = [text.rstrip("\r\n") for text in islice(lines, 60)]
    if not some:
        raise LogError(f"{name}: empty, it needs a header row and samples")
    remarks = next((i for i, line in enumerate(some) if not line.startswith("#")), len(some))
    title, before = remarks, remarks + 1
    text = some[title] if title < len(some) else ""
    if remarks and (remarks == len(some) or _numbers_only(text)):
        title, before = remarks - 1, remarks
        text = some[title].lstrip("# ")
    elif title < len(some):
        title = _header_line(some, title)
        before, text = title + 1, some[title]
    if not text.strip() or "\0" in text or "\r" in text:
        raise LogError(f"{name}, row {title + 1}: no header, give column names there")
    separator = _separator(text)
    names = [cell.strip() for cell in next(csv.reader([text], delimiter=separator))]
    units: tuple[str, ...] = ()
    below = some[before] if before < len(some) else ""
    cells = _cells(below, separator)
    if any(cells) and len(cells) >= len(names) and _is_units_line(cells):
        units, before = tuple(cells), before + 1
    sample = next(filter(None, some[before:]), "")
    names = _as_wide_as(names, _cells(sample, separator))
    after = "\n".join(some[before:])
    point = "," if separator != "," and re.search(r"\d,\d", after) else "."
    return _Layout(
        names=[cell or None for cell in names],
        separator=separator,
        point=point,
        before=before,
        zoned=_zoned(names, separator, after),
        title=title + 1,
        skipped=title if title > remarks else 0,
        units=units,
    )


def _separator(header: str) -> str:
    return next((x for x in _SEPARATORS if x in header), ",")


def _cells(line: str, separator: str) -> list[str]:
    try:
        return [x.strip() for x in next(csv.reader([line], delimiter=separator), [])]
    except csv.Error:  # said where the cells are read
        return []


def _is_sample(cells: list[str]) -> bool:
    """Whether cells are numbers or dates, two or more of them."""
    found = [x for x in cells if x]
    return len(found) > 1 and all(
        _NUMBER.fullmatch(x.replace(",", ".")) or _MOMENT.fullmatch(x) for x in found
    )


def _is_units_line(cells: list[str]) -> bool:
    return all(map(is_unit, cells)) and not _is_sample(cells)


def _header_line(lines: list[str], first: int) -> int:
    """Index of the first line that names a column for each cell of the samples below it.

    If there is no such line, the first line is the header, and the samples are reported as wrong.
    """
    wider = []
    for i in range(first, len(lines)):
        separator = _separator(lines[i])
        names = _cells(lines[i], separator)
        named = [x for x in names if x]
        if len(named) < 2 or any(_NUMBER.fullmatch(x) for x in named):
            continue
        below = (_cells(x, separator) for x in lines[i + 1 :])
        width = next((_last(cells) for cells in below if _is_sample(cells)), None)
        if width == _last(names):
            # recorders number their channels in one line and name them in the next
            following = _cells(lines[i + 1], separator)
            numbers = any(_NUMBER.fullmatch(x.replace(",", ".")) for x in following)
            better = _last(following) == width and not numbers and not _is_units_line(following)
            return i + 1 if better else i
        if width is not None and width < _last(names):
            wider.append(i)
    return wider[0] if wider else first


def _last(cells: list[str]) -> int:
    """Number of cells up to the last that is not empty."""
    return max((i for i, x in enumerate(cells, start=1) if x), default=0)


def _as_wide_as(names: list[str], sample: list[str]) -> list[str]:
    """Column names for every cell of a sample, if the surplus names or cells are empty."""
    wide = len(sample)
    if sample and wide < len(names) and not any(names[wide:]):
        return names[:wide]
    if wide > len(names) and not any(sample[len(names) :]):
        return names + [""] * (wide - len(names))
    return names


def _zoned(names: list[str], separator: str, some: str) -> dict[str, bool]:
    """Columns that begin with a date and a time, and whether each states a time zone.

    Args:
        some: the first lines that may be samples.
    """
    sample = _cells(next(filter(None, re.split(r"[\r\n]", some)), ""), separator)
    cells = zip(names, map(_MOMENT.fullmatch, sample), strict=False)
    return {name: bool(cell[_ZONE]) for name, cell in cells if cell}


def _numbers_only(line: str) -> bool:
    """Whether a line contains only numbers."""
    return all(_NUMBER.fullmatch(x) for x in re.split(r"[,;\s]+", line))
