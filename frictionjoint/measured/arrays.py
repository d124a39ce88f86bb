"""Named columns from npz, MATLAB, HDF5 and Parquet files, real and of float64, or an error.

Rows or columns of a matrix are named as in Python: ``q[0]``. HDF5 files are written by data sets of
robot learning and by MATLAB 7.3; their arrays are named by path, ``observations/qpos[0]``.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib import import_module
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


@contextmanager
def whole(path: Path) -> Iterator[None]:
    """Raise a LogError for any error of a parser, which raises many kinds on a corrupt file."""
    try:
        yield
    except LogError:
        raise
    except Exception as error:
        raise LogError(f"{path.name}: cannot be read, is it whole? ({one_line(error)})") from None


def library(path: Path, kind: str, module: str, package: str | None = None) -> Any:
    """An optional module that reads a kind of file; LogError with how to install what is missing,
    a package of another name if one is given."""
    try:
        return import_module(module)
    except ImportError:
        name = module.partition(".")[0]
        what = f"reading {kind} needs {name}: pip install {package or name}"
        raise LogError(f"{path.name}: {what}") from None


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
    with whole(path), np.load(path, allow_pickle=False) as archive:
        yield archive


def npz_names(path: Path) -> list[str]:
    """Names of the arrays in an .npz file, of the signals in a recording of mujoco.sysid."""
    with opened_npz(path) as archive:
        return list(mujoco_sysid.signals(archive) or archive.files)


def npz_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    with opened_npz(path) as archive:
        return _columns(path, names, mujoco_sysid.signals(archive) or archive)


def mat_names(path: Path) -> list[str]:
    with whole(path):
        if matlab.is_level_5(path):
            return matlab.variable_names(path)
        return [name for name, _, _ in whosmat(path)]


def mat_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    wanted = sorted({array_of(name) for name in names})
    with whole(path):
        level_5 = matlab.is_level_5(path)
        try:
            found = matlab.arrays(path, wanted) if level_5 else loadmat(path, variable_names=wanted)
        except matlab.NotNumbersError as error:
            raise LogError(f"{path.name}, {error}") from None
    return _columns(path, names, found)


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
    with whole(path):
        return library(path, "HDF5", "h5py").File(path, "r")


def _columns(path: Path, names: Iterable[str], arrays: Any) -> dict[str, Array]:
    """Columns of arrays by name, or their named parts; an array may have such a name itself."""
    sources = {x: x if x in arrays else array_of(x) for x in names}
    used = {source: arrays[source] for source in {*sources.values()}}
    return {name: column(path, name, used[x], x) for name, x in sources.items()}


def parquet_names(path: Path) -> list[str]:
    with whole(path):
        return list(_arrow(path, "parquet").read_schema(path).names)


def parquet_rows(path: Path, names: Iterable[str], filters: Any = None) -> Any:
    """Arrow table of some columns; `filters` as pyarrow has them."""
    with whole(path):
        return _arrow(path, "parquet").read_table(path, columns=list(names), filters=filters)


def parquet_column(path: Path, name: str, of_time: bool) -> Array:
    """A column of numbers, shape (n,), missing cells NaN; a column `of_time` may be of dates, which
    become seconds since the first."""
    x, types = parquet_rows(path, [name])[name], _arrow(path, "types")
    if of_time and types.is_timestamp(x.type):
        moments = x.to_numpy()
        return np.asarray((moments - moments[:1]) / np.timedelta64(1, "s"))
    if not (types.is_floating(x.type) or types.is_integer(x.type)):
        raise LogError(f"{path.name}, {name}: {x.type} is not a column of numbers")
    numbers = np.asarray(x.to_numpy(), dtype=np.float64)
    return numbers if numbers.flags.writeable else numbers.copy()


def _arrow(path: Path, part: str) -> Any:
    return library(path, "Parquet", f"pyarrow.{part}", "'frictionjoint[parquet]'")
