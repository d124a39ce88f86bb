"""Results of commands: JSON, pages, and checks that a file can be written without harm."""

import json
import tempfile
import webbrowser
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from frictionjoint.errors import FrictionJointError

Force = Annotated[bool, typer.Option("--force", help="Overwrite existing files, except inputs.")]
Open = Annotated[bool, typer.Option("--open", help="Open the page in the browser.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def require_writable(
    out: Path, made_from: Iterable[Path], force: bool, files: Sequence[str] | None = None
) -> None:
    """Check that a result can be written, before the work; nothing is left behind.

    Args:
        out: a file; or a folder, with the names of its `files`. force: whether they may exist.
        made_from: files that the command reads, including files that a model includes.
    Raises:
        FrictionJointError: it cannot be written, or would overwrite a file without `force`, or a
            file of `made_from`.
    """
    folder = files is not None
    if out.exists() and out.is_dir() != folder:
        fix = "a file has this name, give a folder" if folder else "a folder has this name"
        raise FrictionJointError(f"--out {out}: {fix}")
    written = [out] if files is None else [out / name for name in files]
    existing = [path for path in written if path.exists()]
    from frictionjoint.model_text import sources

    for part in (part for source in made_from for part in sources(source) if part.exists()):
        if same := [path for path in existing if path.samefile(part)]:
            fix = "give another --out"
            raise FrictionJointError(f"{same[0]} is an input of this command: {fix}")
    if existing and not force:
        fix = "give another --out, or --force to overwrite it"
        raise FrictionJointError(f"{existing[0]} exists already: {fix}")
    place = out.absolute() if folder else out.absolute().parent
    while not place.exists():
        place = place.parent
    try:
        with tempfile.TemporaryDirectory(prefix=".frictionjoint-", dir=place):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"--out {out}: cannot be written: {reason}") from None


def print_json(content: Any) -> None:
    typer.echo(json.dumps(content, indent=2))


def open_page(page: Path) -> None:
    """Open a page in the browser, if there is one."""
    webbrowser.open(page.absolute().as_uri())
