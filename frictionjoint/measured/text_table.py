"""CSV files: header, columns, and the line of a bad cell.

The separator is the comma; a header without commas may use semicolons or tabs. Blank lines hold
no sample and count as lines in messages.
"""

import csv
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line

_LONGEST_HEADER = 1 << 20
# What Arrow takes as a number or as an empty cell.
_NUMBER = re.compile(r"\s*([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf(inity)?|nan))?\s*", re.I)


def header(path: Path) -> list[str]:
    """Column names of a CSV file.

    Raises:
        LogError: the file is empty or no text.
    """
    line = _header_line(path)
    return [name.strip() for name in next(csv.reader([line], delimiter=_separator(line)))]


def read_columns(path: Path, names: list[str]) -> dict[str, Array]:
    """Some columns of a CSV file, each of shape (n,).

    Only these are parsed: 8 bytes a number in the end, 16 at most meanwhile, plus small blocks.

    Raises:
        LogError: line-exact, for a cell that is no number or a line of another width.
    """
    all_names = header(path)
    read = pa.csv.ReadOptions(column_names=all_names, skip_rows=1)
    parse = pa.csv.ParseOptions(delimiter=_separator(_header_line(path)))
    convert = pa.csv.ConvertOptions(
        include_columns=names, column_types=dict.fromkeys(names, pa.float64())
    )
    try:
        table = pa.csv.read_csv(path, read, parse, convert)
    except (pa.ArrowException, UnicodeDecodeError):
        read.use_threads = False  # then Arrow's message names the row
        try:
            table = pa.csv.read_csv(path, read, parse, convert)
        except (pa.ArrowException, UnicodeDecodeError) as error:
            raise LogError(_first_fault(path, all_names, names, one_line(error))) from None
    columns = {}
    for name in names:
        columns[name] = owned(table[name])
        table = table.drop_columns(name)
    return columns


def owned(column: pa.ChunkedArray) -> Array:
    """An Arrow column of numbers as an array of its own, missing cells NaN; one copy at most."""
    x = np.asarray(column.to_numpy(), dtype=np.float64)
    return x if x.flags.writeable else x.copy()


def line_of(path: Path, sample: int) -> int:
    """Line number, from 1, of a sample; blank lines between are counted, not sampled."""
    for i, (number, _) in enumerate(_data_lines(path)):
        if i == sample:
            return number
    return sample + 2


def _header_line(path: Path) -> str:
    try:
        with path.open(encoding="utf-8-sig") as file:
            line = file.readline(_LONGEST_HEADER)
    except UnicodeDecodeError:
        raise LogError(f"{path.name}: not text in UTF-8, save it as such") from None
    except OSError as error:
        raise LogError(f"{path.name}: cannot be read: {error.strerror}") from None
    if not line:
        raise LogError(f"{path.name}: empty, it needs a header row and samples")
    line = line.rstrip("\r\n")
    if not line.strip() or "\0" in line or "\r" in line:
        raise LogError(f"{path.name}, row 1: no header, give column names there")
    return line


def _separator(line: str) -> str:
    return "," if "," in line else ";" if ";" in line else "\t" if "\t" in line else ","


def _data_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Number and text of every line that holds a sample."""
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        number = 0
        for chunk in file:
            # Arrow ends a line at a lone carriage return too
            for line in chunk.rstrip("\n").removesuffix("\r").split("\r"):
                number += 1
                if number > 1 and line:
                    yield number, line


def _first_fault(path: Path, all_names: list[str], names: list[str], error: str) -> str:
    """Find the cell Arrow stumbled over, to name its line and column."""
    separator = _separator(_header_line(path))
    number = 1
    # Arrow's row, the header being the first and blank lines uncounted: no need to parse the rest
    row = re.search(r"Row #(\d+)", error)
    for number, line in islice(_data_lines(path), max(0, int(row[1]) - 2) if row else 0, None):
        try:
            cells = next(csv.reader([line], delimiter=separator))
        except csv.Error as fault:
            return f"{path.name}, row {number}: {one_line(fault)}"
        if len(cells) != len(all_names):
            return (
                f"{path.name}, row {number}: {len(cells)} cells, the header has "
                f"{len(all_names)}: complete the row or leave it out"
            )
        for name, cell in zip(all_names, cells, strict=True):
            if name in names and not _NUMBER.fullmatch(cell):
                return f"{path.name}, row {number}, {name}: {cell[:40]!r} is not a number"
    if number == 1:
        return f"{path.name}: no samples under the header, record some"
    return f"{path.name}: cannot be read as a table: {error}"
