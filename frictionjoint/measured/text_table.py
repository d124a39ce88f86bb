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
import re
from collections.abc import Container, Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.csv

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line
from frictionjoint.measured.units import is_unit

ENDINGS = (".csv", ".tsv", ".txt", ".dat")
_LONGEST_HEADER = 1 << 20
_SEPARATORS = ",;\t "
# lines among which the header and the first samples are looked for
_SOME = 60
# name of a column that has none
_UNNAMED = "(column {})"
# What Arrow takes as a number or as an empty cell.
_NUMBER = re.compile(r"\s*([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf(inity)?|nan))?\s*", re.I)
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
        moments: type of date columns. title: line number of the header.
        skipped: lines above it that are no comments.
        units: cell below each name, if there is a line of units.
    """

    names: list[str | None]
    separator: str
    point: str
    before: int
    moments: dict[str, pa.DataType]
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

    Only these are parsed: 8 bytes per number in the result, at most 16 while reading.

    Args:
        time: the column that may contain dates and times.
    Raises:
        LogError: with the line number, for a cell that is no number or a line of another width.
    """
    layout = _layout(path)
    moments = {name: kind for name, kind in layout.moments.items() if name == time}
    read = pa.csv.ReadOptions(column_names=layout.all_names, skip_rows=layout.before)
    parse = pa.csv.ParseOptions(delimiter=layout.separator)
    convert = pa.csv.ConvertOptions(
        include_columns=names,
        column_types=dict.fromkeys(names, pa.float64()) | moments,
        decimal_point=layout.point,
    )
    try:
        table = pa.csv.read_csv(path, read, parse, convert)
    except (pa.ArrowException, UnicodeDecodeError):
        read.use_threads = False  # then Arrow's message names the row
        try:
            table = pa.csv.read_csv(path, read, parse, convert)
        except (pa.ArrowException, UnicodeDecodeError) as error:
            fault = _first_fault(path, layout, names, moments, one_line(error))
            raise LogError(fault) from None
    columns = {}
    for name in names:
        columns[name] = owned(table[name])
        table = table.drop_columns(name)
    return columns


def owned(column: pa.ChunkedArray) -> Array:
    """An Arrow column of numbers as a new array, missing cells NaN; at most one copy.

    For dates and times, the seconds since the first.
    """
    if pa.types.is_timestamp(column.type):
        moments = column.to_numpy()
        return np.asarray((moments - moments[:1]) / np.timedelta64(1, "s"))
    x = np.asarray(column.to_numpy(), dtype=np.float64)
    return x if x.flags.writeable else x.copy()


def line_of(path: Path, sample: int) -> int:
    """Line number, from 1, of a sample; blank lines are counted as lines, not as samples."""
    before = _layout(path).before
    for i, (number, _) in enumerate(_data_lines(path, before)):
        if i == sample:
            return number
    return before + sample + 1


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
    some = [text.rstrip("\r\n") for text in islice(lines, _SOME)]
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
        moments=_moments(names, separator, after),
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

    If there is none, the first line: it is the header then, and the samples are wrong.
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
    """Names for every cell of a sample, if the surplus of either is empty."""
    wide = len(sample)
    if sample and wide < len(names) and not any(names[wide:]):
        return names[:wide]
    if wide > len(names) and not any(sample[len(names) :]):
        return names + [""] * (wide - len(names))
    return names


def _moments(names: list[str], separator: str, some: str) -> dict[str, pa.DataType]:
    """Type of each column that begins with a date and a time.

    Args:
        some: the first lines that may be samples.
    """
    sample = _cells(next(filter(None, re.split(r"[\r\n]", some)), ""), separator)
    cells = zip(names, map(_MOMENT.fullmatch, sample), strict=False)
    return {
        name: pa.timestamp("ns", "UTC" if cell[_ZONE] else None) for name, cell in cells if cell
    }


def _numbers_only(line: str) -> bool:
    """Whether a line contains only numbers."""
    return all(_NUMBER.fullmatch(x) for x in re.split(r"[,;\s]+", line))


def _data_lines(path: Path, before: int) -> Iterator[tuple[int, str]]:
    """Number and text of every sample line, after the first `before` lines."""
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        number = 0
        for chunk in file:
            # Arrow ends a line at a lone carriage return too
            for line in chunk.rstrip("\n").removesuffix("\r").split("\r"):
                number += 1
                if number > before and line:
                    yield number, line


def _first_fault(
    path: Path, layout: _Layout, names: list[str], moments: Container[str], error: str
) -> str:
    """Find the cell that Arrow could not read, and name its line and column."""
    all_names, number = layout.all_names, 0
    # Arrow's row, the header being the first and blank lines uncounted: no need to parse the rest
    row = re.search(r"Row #(\d+)", error)
    first = max(0, int(row[1]) - 1 - layout.before) if row else 0
    for number, line in islice(_data_lines(path, layout.before), first, None):
        try:
            cells = next(csv.reader([line], delimiter=layout.separator))
        except csv.Error as fault:
            return f"{path.name}, row {number}: {one_line(fault)}"
        if len(cells) != len(all_names):
            return (
                f"{path.name}, row {number}: {len(cells)} cells, the header has "
                f"{len(all_names)}: complete the row or leave it out"
            )
        for name, cell in zip(all_names, cells, strict=True):
            of_dates = name in moments
            kind = _MOMENT if of_dates else _NUMBER
            text = cell if of_dates else cell.replace(layout.point, ".")
            if name in names and cell and not kind.fullmatch(text):
                wanted = "date with a time, as that of the first row is" if of_dates else "number"
                return f"{path.name}, row {number}, {name}: {cell[:40]!r} is not a {wanted}"
    if not number:
        return f"{path.name}: no samples under the header, record some"
    return f"{path.name}: cannot be read as a table: {error}"
