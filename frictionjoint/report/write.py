"""Write a folder as a whole or not at all."""

import contextlib
import os
import secrets
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

from frictionjoint.errors import FrictionJointError

# by name of a file
Contents = Mapping[str, str | bytes]
Checks = Mapping[str, Callable[[Path], None]]


def write_files(folder: Path, contents: Contents, checks: Checks | None = None) -> None:
    """Write files into a folder, all of them or none, even if the run is interrupted.

    They are first written under hidden names. A new folder then gets its name in one step; into an
    existing folder each finished file is moved.

    Args:
        checks: by name of a file: called with the path of the finished file, before it is renamed,
            in the folder itself or one next to it.
    Raises:
        FrictionJointError: the folder cannot be written; nothing new stays in it.
    """
    # a name, or the beginning of names, that nothing else has
    hidden = f".frictionjoint-{secrets.token_hex(4)}-"
    try:
        write = _into if folder.exists() else _as_new
        write(folder, hidden, contents, checks or {})
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"{folder}: cannot write the result: {reason}") from None


def _as_new(folder: Path, hidden: str, contents: Contents, checks: Checks) -> None:
    parent = folder.absolute().parent
    missing = [p for p in (parent, *parent.parents) if not p.exists()]
    staging = parent / hidden
    try:
        parent.mkdir(parents=True, exist_ok=True)
        staging.mkdir()
        _finish(staging, "", contents, checks)
        os.rename(staging, folder)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        for empty in missing:
            with contextlib.suppress(OSError):
                empty.rmdir()
        raise


def _into(folder: Path, hidden: str, contents: Contents, checks: Checks) -> None:
    try:
        _finish(folder, hidden, contents, checks)
        for name in contents:
            os.replace(folder / (hidden + name), folder / name)
    finally:
        for name in contents:
            with contextlib.suppress(OSError):
                (folder / (hidden + name)).unlink()


def _finish(folder: Path, prefix: str, contents: Contents, checks: Checks) -> None:
    """Write and check all files under names with a prefix."""
    for name, content in contents.items():
        data = content if isinstance(content, bytes) else content.encode()
        (folder / (prefix + name)).write_bytes(data)
    for name, check in checks.items():
        check(folder / (prefix + name))
