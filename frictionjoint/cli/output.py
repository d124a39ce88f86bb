"""Where results go: whether they can be written and would overwrite their sources."""

import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.errors import FrictionJointError

Force = Annotated[
    bool, typer.Option("--force", help="Let --out overwrite a file that it is made from.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def require_writable(
    out: Path, made_from: Iterable[Path], force: bool, files: Sequence[str] | None = None
) -> None:
    """See that a result can be written, before the work; nothing is left behind.

    Args:
        out: a file; a folder where `files` are given, the names of what is written into it.
        made_from: files that the command reads; what a model includes is one of them.
        force: whether those may be overwritten.
    Raises:
        FrictionJointError: it cannot be written, or would overwrite what it is made from.
    """
    folder = files is not None
    if out.exists() and out.is_dir() != folder:
        mend = "a file has this name, give a folder" if folder else "a folder has this name"
        raise FrictionJointError(f"--out {out}: {mend}")
    if not force:
        _require_others([out] if files is None else [out / name for name in files], made_from)
    place = out.absolute() if folder else out.absolute().parent
    while not place.exists():
        place = place.parent
    try:
        with tempfile.TemporaryDirectory(prefix=".frictionjoint-", dir=place):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"--out {out}: cannot be written: {reason}") from None


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
                        f"{path} is what the result is made from: give another --out, or --force "
                        "to overwrite it"
                    )
