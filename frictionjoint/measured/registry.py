"""Public measured data: addresses pinned to a commit, hashes, licences.

The package contains no such data. Files are fetched from their authors' repositories with pooch
into its cache folder. If the environment variable FRICTIONJOINT_DATA names a local folder with a
subfolder per data set, that is used instead, and never the network.
"""

import functools
import os
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pooch

from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line


@dataclass(frozen=True)
class DataSet:
    """Logs from one source: its page, what was measured, its licence as its authors state it.

    Attributes:
        name: argument of `get_data`, and name of its folder in a local copy.
        address: of the folder with the files, including the commit. files: name -> sha256.
        logs: arguments of `read_log`, relative to the folder; ``.`` is the folder itself.
    """

    name: str
    title: str
    licence: str
    source: str
    address: str
    files: MappingProxyType[str, str]
    logs: tuple[str, ...]


@functools.cache
def _sets() -> dict[str, DataSet]:
    text = files("frictionjoint.measured").joinpath("public_logs.toml").read_text("utf-8")
    found = {}
    for name, table in tomllib.loads(text).items():
        pinned = MappingProxyType(table.pop("files"))
        logs = tuple(table.pop("logs", pinned))
        found[name] = DataSet(name=name, files=pinned, logs=logs, **table)
    return found


def list_data() -> tuple[DataSet, ...]:
    """All data sets that `get_data` can fetch."""
    return tuple(_sets().values())


def get_data(name: str) -> Path:
    """Folder with the files of a data set, fetched if need be, hashes checked; LogError for an
    unknown name, a file missing or altered, or no network."""
    if name not in _sets():
        raise LogError(f"no data set {name!r}, there are {', '.join(_sets())}")
    data = _sets()[name]
    local = os.environ.get("FRICTIONJOINT_DATA")
    return _local(data, Path(local) / name) if local else _fetched(data)


def _local(data: DataSet, folder: Path) -> Path:
    for file, digest in data.files.items():
        path = folder / file
        if not path.is_file():
            raise LogError(f"{path}: missing, complete it or unset FRICTIONJOINT_DATA")
        if pooch.file_hash(str(path)) != digest:
            raise LogError(f"{path}: not the published file, its sha256 is not {digest[:12]}...")
    return folder


def _fetched(data: DataSet) -> Path:
    registry: dict[str, Any] = {file: f"sha256:{digest}" for file, digest in data.files.items()}
    folder = Path(pooch.os_cache("frictionjoint")) / data.name
    pooch.get_logger().setLevel("WARNING")  # its progress lines would hide our one line
    shelf = pooch.create(folder, f"{data.address}/", registry=registry, retry_if_failed=1)
    for file in data.files:
        try:
            shelf.fetch(file)
        except (OSError, ValueError) as error:  # requests' errors are OSErrors
            what = f"{file} could not be fetched from {data.source}: {one_line(error)}"
            fix = "check the network, or set FRICTIONJOINT_DATA to a local folder"
            raise LogError(f"{data.name}: {what}: {fix}") from None
    return folder
