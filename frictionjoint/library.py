"""The shared library of the kernels: found, loaded once, and in a source tree kept up to date.

An installed package has the library from its wheel. In a source tree (``pip install -e .``) it is
built again when the source of a kernel has changed, into ``frictionjoint/_native``.
"""

import ctypes
import functools
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

_PACKAGE = Path(__file__).parent
FOLDER = _PACKAGE / "_native"
LISTED = "kernels.json"


class Parameter(NamedTuple):
    """One argument of a kernel.

    Attributes:
        kind: its C type. written: whether it is written to. axes: whose lengths go along.
        fields: of a NamedTuple, their C types.
    """

    name: str
    kind: str
    written: bool
    axes: list[int]
    fields: dict[str, str]


class Entry(NamedTuple):
    """A kernel in the library: its symbol, result and parameters."""

    symbol: str
    result: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True)
class Library:
    """The loaded library and its kernels by module and name."""

    path: Path
    shared: ctypes.CDLL
    entries: dict[str, Entry]


def load(kernel: str = "") -> Library:
    """The library of this package; `kernel`: module and name of one that it must contain.

    Raises:
        RuntimeError: no library contains the kernel, or the library could not be built.
    """
    if kernel and kernel not in _load().entries and _is_source_tree():
        # in a file that had none when the library was built
        _load.cache_clear()
        _rebuild()
    found = _load()
    if kernel and kernel not in found.entries:
        raise RuntimeError(f"{found.path} lacks the kernel {kernel}: install frictionjoint again")
    return found


@contextmanager
def _alone() -> Iterator[None]:
    """Allow one process at a time to build, if the file system supports locks."""
    FOLDER.mkdir(exist_ok=True)
    with open(FOLDER / "lock", "w", encoding="utf-8") as held:
        if sys.platform != "win32":
            import fcntl

            fcntl.flock(held, fcntl.LOCK_EX)
        yield


@functools.cache
def _load() -> Library:
    if _is_source_tree() and not _is_fresh():
        with _alone():
            if not _is_fresh():
                _rebuild()
    try:
        listed = json.loads((FOLDER / LISTED).read_text(encoding="utf-8"))
        path = FOLDER / listed["library"]
        shared = ctypes.CDLL(str(path))
    except (OSError, ValueError, KeyError) as error:
        raise RuntimeError(
            f"the compiled kernels cannot be loaded ({error}): install frictionjoint again"
        ) from error
    entries = {
        name: Entry(symbol, result, tuple(Parameter(*each) for each in parameters))
        for name, (symbol, result, parameters) in listed["kernels"].items()
    }
    return Library(path, shared, entries)


def sources() -> list[Path]:
    """Files of this package whose text the library depends on."""
    return [
        file
        for file in sorted(_PACKAGE.rglob("*.py"))
        if file.parent.name in ("translate", "tangents")
        or b"frictionjoint.compiled import" in file.read_bytes()
    ]


def _is_source_tree() -> bool:
    return (_PACKAGE.parent / "pyproject.toml").is_file()


def stamps(files: list[Path]) -> dict[str, list[int]]:
    """Size and time of change of files, by their place in the package."""
    stats = {file.relative_to(_PACKAGE).as_posix(): file.stat() for file in files}
    return {name: [stat.st_size, stat.st_mtime_ns] for name, stat in stats.items()}


def _is_fresh() -> bool:
    """Whether the library is there and none of its sources has changed."""
    try:
        listed: dict[str, Any] = json.loads((FOLDER / LISTED).read_text(encoding="utf-8"))
        known: dict[str, list[int]] = listed["sources"]
        same = stamps([_PACKAGE / name for name in known]) == known
        return same and (FOLDER / listed["library"]).is_file()
    except (OSError, ValueError, KeyError):
        return False


def _rebuild() -> None:
    """Translate and compile in a process of its own, where kernels are plain Python.

    Without the folder in which it runs on its path: there another copy of the package may lie.
    """
    environment = {
        **os.environ,
        "FRICTIONJOINT_PYTHON": "1",
        "PYTHONPATH": os.pathsep.join(
            [str(_PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])]
        ),
    }
    done = subprocess.run(
        [sys.executable, "-P", "-m", "frictionjoint.translate.build", str(FOLDER)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"the kernels could not be compiled:\n{done.stderr[-4000:]}")
