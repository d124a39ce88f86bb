"""Columns of Parquet files, read with pyarrow where it is installed."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import corrupt


def column_names(path: Path) -> list[str]:
    """Names of a file's columns, without reading its rows; LogError if pyarrow is missing, or it
    cannot read the file."""
    arrow = _arrow(path)
    try:
        return list(arrow.parquet.read_schema(path).names)
    except (OSError, ValueError, arrow.ArrowException) as error:
        raise corrupt(path, error) from None


def read_rows(path: Path, names: Iterable[str], filters: Any = None) -> Any:
    """Arrow table of some columns; `filters` as pyarrow has them."""
    arrow = _arrow(path)
    try:
        return arrow.parquet.read_table(path, columns=list(names), filters=filters)
    except (OSError, ValueError, KeyError, arrow.ArrowException) as error:
        raise corrupt(path, error) from None


def read_column(path: Path, name: str, of_time: bool) -> Array:
    """A column of numbers, shape (n,), missing cells NaN; a column `of_time` may be of dates, which
    become seconds since the first."""
    x, types = read_rows(path, [name])[name], _arrow(path).types
    if of_time and types.is_timestamp(x.type):
        moments = x.to_numpy()
        return np.asarray((moments - moments[:1]) / np.timedelta64(1, "s"))
    if not (types.is_floating(x.type) or types.is_integer(x.type)):
        raise LogError(f"{path.name}, {name}: {x.type} is not a column of numbers")
    numbers = np.asarray(x.to_numpy(), dtype=np.float64)
    return numbers if numbers.flags.writeable else numbers.copy()


def _arrow(path: Path) -> Any:
    try:
        import pyarrow.parquet
    except ImportError:
        raise LogError(
            f"{path.name}: reading Parquet needs pyarrow: pip install 'frictionjoint[parquet]'"
        ) from None
    return pyarrow
