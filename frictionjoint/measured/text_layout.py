"""Layout of a text table: where its header and samples are, and how its cells are separated."""

import csv
import re
from collections.abc import Iterator
from functools import partial
from itertools import islice
from pathlib import Path

from frictionjoint.errors import LogError
from frictionjoint.measured.units import is_unit

_SEPARATORS = ",;\t "
# name of a column that has none
_UNNAMED = "(column {})"
# What is taken as a number or as an empty cell.
_NUMBER = re.compile(
    r"\s*([+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(inf(inity)?|nan))?\s*", re.I | re.A
)
# A date with a time, and its difference to universal time.
MOMENT = re.compile(
    r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d{1,9})?)?(?P<zone>Z|[+-]\d\d(:?\d\d)?)?\s*"
)


class Layout:
    """Layout of a file, by its first lines.

    Attributes:
        columns: a name for each of its columns. names: those that the header has.
        separator: between cells. point: decimal separator.
        before: lines before the first that may be a sample.
        zoned: date columns, and whether they name their time zone.
        units: cell below each name, if there is a line of units.
        note: on lines above the header that are no comments; empty for none.
    """

    def __init__(self, file: str, lines: Iterator[str]) -> None:
        # header and first samples are within 60 lines
        some = [text.rstrip("\n") for text in islice(lines, 60)]
        if not some:
            raise LogError(f"{file}: empty, it needs a header row and samples")
        remarks = next((i for i, line in enumerate(some) if not line.startswith("#")), len(some))
        title, before = remarks, remarks + 1
        text = some[title] if title < len(some) else ""
        cells = re.split(r"[,;\s]+", text)
        if remarks and (remarks == len(some) or all(map(_NUMBER.fullmatch, cells))):
            title, before = remarks - 1, remarks
            text = some[title].lstrip("# ")
        elif title < len(some):
            title = _header_line(some, title)
            before, text = title + 1, some[title]
        if not text.strip() or "\0" in text:
            fix = "give column names there"
            raise LogError(f"{file}, row {title + 1}: no header in UTF-8 text, {fix}")
        separator = _separator(text)
        names = [cell.strip() for cell in next(csv.reader([text], delimiter=separator))]
        units: list[str] = []
        below = some[before] if before < len(some) else ""
        cells = _cells(below, separator)
        if any(cells) and len(cells) >= len(names) and _is_units_line(cells):
            units, before = cells, before + 1
        sample = _cells(next(filter(None, some[before:]), ""), separator)
        names = _as_wide_as(names, sample)
        dates = zip(names, map(MOMENT.fullmatch, sample), strict=False)
        with_comma = any(re.search(r"\d,\d", line) for line in some[before:])
        self.columns = [x or _UNNAMED.format(i) for i, x in enumerate(names, start=1)]
        self.names = [x for x in names if x]
        self.separator = separator
        self.point = "," if separator != "," and with_comma else "."
        self.before = before
        self.zoned = {name: bool(date["zone"]) for name, date in dates if date}
        self.units = {name: unit for name, unit in zip(names, units, strict=False) if name}
        above = "line 1" if title == 1 else f"lines 1 to {title}"
        skipped = f"{above} skipped: the header with the column names is line {title + 1}."
        self.note = skipped if title > remarks else ""


def layout_of(path: Path) -> Layout:
    """Layout of a file; LogError if the file is empty or no text."""
    for encoding in ("utf-8-sig", "cp1252"):  # Excel writes the second
        try:
            with path.open(encoding=encoding) as file:
                # a header is shorter than a megabyte
                return Layout(path.name, iter(partial(file.readline, 1 << 20), ""))
        except UnicodeDecodeError:
            continue
        except OSError as error:
            raise LogError(f"{path.name}: cannot be read: {error.strerror}") from None
    raise LogError(f"{path.name}: not text in UTF-8, save it as UTF-8")


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
        _NUMBER.fullmatch(x.replace(",", ".")) or MOMENT.fullmatch(x) for x in found
    )


def _is_units_line(cells: list[str]) -> bool:
    return all(map(is_unit, cells)) and not _is_sample(cells)


def _header_line(lines: list[str], first: int) -> int:
    """Index of the first line that names a column for each cell below it; else `first`."""
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
