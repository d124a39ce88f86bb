"""Named arrays from npz and MATLAB files, as real columns of float64 or an error.

Rows or columns of a matrix are named as in Python: ``q[0]``.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured import matlab, mujoco_sysid

_PART = re.compile(r"(.+)\[(\d+)\]")


def one_line(error: Exception) -> str:
    """An error's text without line breaks, cut to a readable length."""
    return " ".join(str(error).split())[:200] or type(error).__name__


def corrupt(path: Path, error: Exception) -> LogError:
    """The error for a file that its parser could not read."""
    return LogError(f"{path.name}: cannot be read, is it whole? ({one_line(error)})")


def whole(name: str) -> str:
    """Name of the array in ``q[0]``; other names are returned unchanged."""
    part = _PART.fullmatch(name)
    return part[1] if part else name


def part_of(value: Any, field: str) -> Any:
    """A field of a message, including parts of fields: ``state.q[2]``."""
    for name in field.split("."):
        part = _PART.fullmatch(name)
        value = getattr(value, part[1] if part else name)
        value = value[int(part[2])] if part else value
    return value


def column(path: Path, name: str, x: Any, source: str | None = None) -> Array:
    """A column of real numbers, shape (n,), also of a 1 x n or n x 1 matrix, or a part of the array
    `source`; LogError for text, complex numbers, objects, or a matrix without a named part."""
    array = np.asarray(x)
    if array.dtype.kind not in "fiub":
        raise LogError(f"{path.name}, {name}: {array.dtype} is not a column of numbers")
    part = None if source in (None, name) else _PART.fullmatch(name)
    if array.size != max(array.shape, default=1):
        array = _part(f"{path.name}, {name}", source or name, part and int(part[2]), array)
    elif part:
        raise LogError(f"{path.name}, {name}: {source} is one column, name it without [...]")
    return array.astype(np.float64).ravel()


def _part(where: str, source: str, number: int | None, array: Array) -> Array:
    """A row or a column of a matrix, along the longer dimension."""
    size = " x ".join(str(k) for k in array.shape)
    if array.ndim != 2 or array.shape[0] == array.shape[1]:
        raise LogError(f"{where}: {size} numbers, give one column per quantity")
    parts = array if array.shape[0] < array.shape[1] else array.T
    last = len(parts) - 1
    if number is None or number > last:
        raise LogError(f"{where}: it is {size}, name a column: {source}[0] to {source}[{last}]")
    return np.asarray(parts[number])


@contextmanager
def opened_npz(path: Path) -> Iterator[Any]:
    """The arrays of an .npz file by name. LogError if the file is corrupt, also where an array is
    read within the context."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            yield archive
    except LogError:
        raise
    except Exception as error:  # zip, zlib and numpy raise different errors on a corrupt file
        raise corrupt(path, error) from None


def npz_names(path: Path) -> list[str]:
    """Names of the arrays in an .npz file, of the signals in a recording of mujoco.sysid."""
    with opened_npz(path) as archive:
        return list(mujoco_sysid.signals(archive) or archive.files)


def npz_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    with opened_npz(path) as archive:
        arrays = mujoco_sysid.signals(archive) or archive
        there = list(arrays)
        # an array may have such a name itself
        sources = {x: x if x in there else whole(x) for x in names}
        used = {source: arrays[source] for source in {*sources.values()}}
        return {name: column(path, name, used[x], x) for name, x in sources.items()}


def mat_names(path: Path) -> list[str]:
    try:
        if matlab.is_level_5(path):
            return matlab.variable_names(path)
        return [name for name, _, _ in whosmat(path)]
    except Exception as error:
        raise corrupt(path, error) from None


def mat_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    sources = {name: whole(name) for name in names}
    wanted = sorted({*sources.values()})
    try:
        level_5 = matlab.is_level_5(path)
        content = matlab.arrays(path, wanted) if level_5 else loadmat(path, variable_names=wanted)
    except matlab.NotNumbersError as error:
        raise LogError(f"{path.name}, {error}") from None
    except Exception as error:
        raise corrupt(path, error) from None
    missing = [name for name in wanted if name not in content]
    if missing:
        raise LogError(f"{path.name}: no variable {missing[0]!r}")
    return {name: column(path, name, content[x], x) for name, x in sources.items()}
