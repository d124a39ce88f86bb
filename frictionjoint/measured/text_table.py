"""Tables as text: header, columns, and the line of a bad cell.

The separator is the comma; a header without commas may use semicolons, tabs or single blanks, and
numbers below it a comma for their point. Lines before the header that begin with # are remarks; the
last of them is the header where only numbers follow, as numpy writes it. Blank lines hold no sample
and count as lines in messages. A column of dates with times, as ISO 8601 writes them, is read as
seconds since its first.
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

ENDINGS = (".csv", ".tsv", ".txt", ".dat")
_LONGEST_HEADER = 1 << 20
_SEPARATORS = ",;\t "
# lines that show how numbers are written
_SOME = 20
# What Arrow takes as a number or as an empty cell.
_NUMBER = re.compile(r"\s*([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf(inity)?|nan))?\s*", re.I)
# A date with a time, and its difference to universal time.
_MOMENT = re.compile(
    r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d{1,9})?)?(Z|[+-]\d\d(:?\d\d)?)?\s*"
)
_ZONE = 3


class _Layout(NamedTuple):
    """How a file is written.

    Attributes:
        names: of its columns. separator: between cells. point: of decimal numbers.
        before: lines before the first that may hold a sample. moments: type of columns of dates.
    """

    names: list[str]
    separator: str
    point: str
    before: int
    moments: dict[str, pa.DataType]


def header(path: Path) -> list[str]:
    """Column names of a file.

    Raises:
        LogError: the file is empty or no text.
    """
    return _layout(path).names


def read_columns(path: Path, names: list[str], time: str | None = None) -> dict[str, Array]:
    """Some columns of a file, each of shape (n,).

    Only these are parsed: 8 bytes a number in the end, 16 at most meanwhile, plus small blocks.

    Args:
        time: the column that may be of dates with times.
    Raises:
        LogError: line-exact, for a cell that is no number or a line of another width.
    """
    layout = _layout(path)
    moments = {name: kind for name, kind in layout.moments.items() if name == time}
    read = pa.csv.ReadOptions(column_names=layout.names, skip_rows=layout.before)
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
    """An Arrow column of numbers as an array of its own, missing cells NaN; one copy at most.

    Of dates with times, the seconds since the first.
    """
    if pa.types.is_timestamp(column.type):
        moments = column.to_numpy()
        return np.asarray((moments - moments[:1]) / np.timedelta64(1, "s"))
    x = np.asarray(column.to_numpy(), dtype=np.float64)
    return x if x.flags.writeable else x.copy()


def line_of(path: Path, sample: int) -> int:
    """Line number, from 1, of a sample; blank lines between are counted, not sampled."""
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
        raise LogError(f"{path.name}: not text in UTF-8, save it as such") from None
    except OSError as error:
        raise LogError(f"{path.name}: cannot be read: {error.strerror}") from None


def _layout_of(name: str, lines: Iterator[str]) -> _Layout:
    """Of a file by its first lines."""
    remark, line, number = "", "", 0
    for text in lines:
        line, number = text.rstrip("\r\n"), number + 1
        if not line.startswith("#"):
            break
        remark = line
    if not number:
        raise LogError(f"{name}: empty, it needs a header row and samples")
    title, before, first = line, number, ""
    if line.startswith("#"):
        title = remark.lstrip("# ")
    elif remark and _numbers_only(line):
        title, before, first = remark.lstrip("# "), number - 1, line
    if not title.strip() or "\0" in title or "\r" in title:
        raise LogError(f"{name}, row {before}: no header, give column names there")
    separator = next((x for x in _SEPARATORS if x in title), ",")
    names = [cell.strip() for cell in next(csv.reader([title], delimiter=separator))]
    some = first + "".join(islice(lines, _SOME))
    point = "," if separator != "," and re.search(r"\d,\d", some) else "."
    return _Layout(names, separator, point, before, _moments(names, separator, some))


def _moments(names: list[str], separator: str, some: str) -> dict[str, pa.DataType]:
    """Type of each column that begins with a date and a time.

    Args:
        some: the first lines that may hold samples.
    """
    first = next(filter(None, re.split(r"[\r\n]", some)), "")
    try:
        sample = next(csv.reader([first], delimiter=separator), [])
    except csv.Error:  # said where its cells are read
        return {}
    cells = zip(names, map(_MOMENT.fullmatch, sample), strict=False)
    return {
        name: pa.timestamp("ns", "UTC" if cell[_ZONE] else None) for name, cell in cells if cell
    }


def _numbers_only(line: str) -> bool:
    """Whether a line holds nothing but numbers."""
    return all(_NUMBER.fullmatch(x) for x in re.split(r"[,;\s]+", line))


def _data_lines(path: Path, before: int) -> Iterator[tuple[int, str]]:
    """Number and text of every line that holds a sample, those `before` them left out."""
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
    """Find the cell Arrow stumbled over, to name its line and column."""
    all_names, number = layout.names, 0
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
