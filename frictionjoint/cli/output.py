"""Checks of output paths: writable, and not overwriting input."""

import tempfile
import webbrowser
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.errors import FrictionJointError

Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]
Open = Annotated[bool, typer.Option("--open", help="Open the page in the browser.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def require_writable(
    out: Path, made_from: Iterable[Path], force: bool, files: Sequence[str] | None = None
) -> None:
    """Check that a result can be written, before the work; nothing is left behind.

    Args:
        out: a file; or a folder, with the names of its `files`.
        made_from: files that the command reads, including files that a model includes.
        force: whether existing files may be overwritten.
    Raises:
        FrictionJointError: it cannot be written, or would overwrite a file without `force`.
    """
    folder = files is not None
    if out.exists() and out.is_dir() != folder:
        fix = "a file has this name, give a folder" if folder else "a folder has this name"
        raise FrictionJointError(f"--out {out}: {fix}")
    if not force:
        written = [out] if files is None else [out / name for name in files]
        _require_others(written, made_from)
        _require_new(written)
    place = out.absolute() if folder else out.absolute().parent
    while not place.exists():
        place = place.parent
    try:
        with tempfile.TemporaryDirectory(prefix=".frictionjoint-", dir=place):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"--out {out}: cannot be written: {reason}") from None


def open_page(page: Path) -> None:
    """Open a page in the browser, if there is one."""
    webbrowser.open(page.absolute().as_uri())


def _require_new(written: Iterable[Path]) -> None:
    for path in written:
        if path.exists():
            raise FrictionJointError(
                f"{path} exists already: give another --out, or --force to overwrite it"
            )


def _require_others(written: Iterable[Path], made_from: Iterable[Path]) -> None:
    from frictionjoint.model_text import sources

    existing = [path for path in written if path.exists()]
    if not existing:
        return
    for source in made_from:
        for part in sources(source):
            for path in existing:
                if part.exists() and path.samefile(part):
                    raise FrictionJointError(
                        f"{path} is an input of this command: give another --out, or --force to "
                        "overwrite it"
                    )
