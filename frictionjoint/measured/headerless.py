"""Tables of numbers without a header, as numpy, MATLAB and recorders in C write them.

Columns are named ``1``, ``2``, ... in their order. Any blanks, commas, semicolons or tabs stand
between the numbers; lines that begin with # or % are remarks. A file of a few very long rows holds
one signal per row, as numpy writes a list of signals: its rows are numbered in place of columns.
"""

import re
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line

_REMARKS = ("#", "%")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?|[+-]?inf(inity)?|nan", re.I)
# a file holds its signals in rows from this many numbers per row on, and a tenth as many rows
_LONG_ROW = 200


def is_bare(path: Path) -> bool:
    """Whether a text file begins with numbers, and no comment above them names the columns."""
    try:
        lines = _first_lines(path)
    except (OSError, UnicodeDecodeError):
        return False
    row = next((i for i, x in enumerate(lines) if x and not x.startswith(_REMARKS)), None)
    if row is None:
        return False
    cells = _cells(lines[row])
    if not all(_NUMBER.fullmatch(x) for x in cells) or cells == [str(i) for i in range(len(cells))]:
        return False  # the second: the numbers that pandas gives columns without a name
    above = next((x for x in reversed(lines[:row]) if x), "")
    names = [x for x in _cells(above.lstrip("#% ")) if x]
    return len(names) != len(cells) or all(_NUMBER.fullmatch(x) for x in names)


def bare_names(path: Path) -> list[str]:
    """Numbers of the columns, or of the rows if each row is a signal, from 1."""
    width, rows = _size(path)
    return [str(i) for i in range(1, (rows or width) + 1)]


def bare_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    """Columns by number, shape (n,) each; LogError for a cell that is no number, or a short row."""
    wanted = list(names)
    _, in_rows = _size(path)
    which = [int(x) - 1 for x in wanted]
    first = next(x for x in _first_lines(path) if x and not x.startswith(_REMARKS))
    separator = _separator(first)
    try:
        with path.open(encoding="utf-8-sig") as file:
            lines = file if separator == "," else (x.replace(",", ".") for x in file)
            at = None if in_rows else which
            table = np.loadtxt(lines, comments=_REMARKS, delimiter=separator, usecols=at, ndmin=2)
    except ValueError as error:
        raise LogError(f"{path.name}: {one_line(error)}") from None
    chosen = table[which] if in_rows else table.T
    return {name: np.ascontiguousarray(x) for name, x in zip(wanted, chosen, strict=True)}


def _size(path: Path) -> tuple[int, int]:
    """Numbers per row, and the number of rows if each row is a signal, else 0."""
    with path.open(encoding="utf-8-sig") as file:
        lines = (x for x in file if x.strip() and not x.startswith(_REMARKS))
        width = len(_cells(next(lines).strip()))
        rows = 1 + sum(1 for _ in lines) if width >= _LONG_ROW else 1
    return width, rows if width >= max(_LONG_ROW, 10 * rows) else 0


def _first_lines(path: Path) -> list[str]:
    with path.open(encoding="utf-8-sig") as file:
        # the first numbers must come within 60 lines
        return [x.strip() for x in islice(file, 60)]


def _separator(line: str) -> str | None:
    """Separator of the cells of a line; None: any blanks, with a decimal comma."""
    return ";" if ";" in line else None if len(line.split()) > 1 and ", " not in line else ","


def _cells(line: str) -> list[str]:
    """Cells of a line; an empty cell after a final separator is left out."""
    separator = _separator(line)
    cells = [x.strip() for x in line.split(separator)]
    if separator != ",":
        cells = [x.replace(",", ".") for x in cells]
    return cells[:-1] if len(cells) > 1 and not cells[-1] else cells
