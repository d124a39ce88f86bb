"""Named arrays from npz, MATLAB and HDF5 files, as real columns of float64 or an error.

Rows or columns of a matrix are named as in Python: ``q[0]``. HDF5 files are written by data sets of
robot learning and by MATLAB 7.3; their arrays are named by path, ``observations/qpos[0]``.
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

HDF5_ENDINGS = (".h5", ".hdf5")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# bytes where it may stand: MATLAB has text of its own before it
_PLACES = (0, 512)
_PART = re.compile(r"(.+)\[(\d+)\]")


def one_line(error: Exception) -> str:
    """An error's text without line breaks, cut to a readable length."""
    return " ".join(str(error).split())[:200] or type(error).__name__


def corrupt(path: Path, error: Exception) -> LogError:
    """The error for a file that its parser could not read."""
    return LogError(f"{path.name}: cannot be read, is it whole? ({one_line(error)})")


def array_of(name: str) -> str:
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
        return _columns(path, names, mujoco_sysid.signals(archive) or archive)


def mat_names(path: Path) -> list[str]:
    try:
        if matlab.is_level_5(path):
            return matlab.variable_names(path)
        return [name for name, _, _ in whosmat(path)]
    except Exception as error:
        raise corrupt(path, error) from None


def mat_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    wanted = sorted({array_of(name) for name in names})
    try:
        level_5 = matlab.is_level_5(path)
        content = matlab.arrays(path, wanted) if level_5 else loadmat(path, variable_names=wanted)
    except matlab.NotNumbersError as error:
        raise LogError(f"{path.name}, {error}") from None
    except Exception as error:
        raise corrupt(path, error) from None
    return _columns(path, names, content)


def is_hdf5(path: Path) -> bool:
    """Whether a file is HDF5, whatever its name."""
    with path.open("rb") as file:
        head = file.read(_PLACES[-1] + len(_SIGNATURE))
    return any(head[at : at + len(_SIGNATURE)] == _SIGNATURE for at in _PLACES)


def hdf5_names(path: Path) -> list[str]:
    """Paths of the arrays of numbers in a file."""
    found: list[str] = []

    def add(name: str, item: Any) -> None:
        numeric = hasattr(item, "dtype") and item.dtype.kind in "fiub"
        if numeric and item.size > 1 and not name.startswith("#"):
            found.append(name)

    with _opened_hdf5(path) as file:
        file.visititems(add)
    return found


def hdf5_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    with _opened_hdf5(path) as file:
        return _columns(path, names, file)


def _opened_hdf5(path: Path) -> Any:
    try:
        import h5py
    except ImportError:
        raise LogError(f"{path.name}: reading HDF5 needs h5py: pip install h5py") from None
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise corrupt(path, error) from None


def _columns(path: Path, names: Iterable[str], arrays: Any) -> dict[str, Array]:
    """Columns of arrays by name, or their named parts; an array may have such a name itself."""
    sources = {x: x if x in arrays else array_of(x) for x in names}
    used = {source: arrays[source] for source in {*sources.values()}}
    return {name: column(path, name, used[x], x) for name, x in sources.items()}
