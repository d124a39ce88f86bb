"""HDF5 files, as data sets of robot learning and MATLAB 7.3 write them: numeric arrays by path.

An array is named by its path in the file, ``observations/qpos``; its columns as those of other
matrices, ``observations/qpos[0]``.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import column, corrupt, whole

ENDINGS = (".h5", ".hdf5")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# bytes where it may stand: MATLAB has text of its own before it
_PLACES = (0, 512)


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

    with _opened(path) as file:
        file.visititems(add)
    return found


def hdf5_columns(path: Path, names: Iterable[str]) -> dict[str, Array]:
    with _opened(path) as file:
        return {name: column(path, name, file[whole(name)][()], whole(name)) for name in names}


def _opened(path: Path) -> Any:
    try:
        import h5py
    except ImportError:
        raise LogError(f"{path.name}: reading HDF5 needs h5py: pip install h5py") from None
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise corrupt(path, error) from None
