"""Build the shared library of the kernels.

    python -m frictionjoint.translate.build FOLDER [TARGET]

A build imports all modules with kernels. In this process the kernels run as Python
(``FRICTIONJOINT_PYTHON=1``).
"""

import hashlib
import importlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from frictionjoint import compiled, library
from frictionjoint.translate.c_file import unit
from frictionjoint.translate.compiler import FLAGS, compile_library


def all_kernels() -> dict[str, Any]:
    """Every kernel of the package by module and name; imports all modules with kernels."""
    for file in library.sources():
        if file.parent.name != "translate":
            place = file.relative_to(Path(library.__file__).parent).with_suffix("")
            parts = [part for part in place.parts if part != "__init__"]
            importlib.import_module(".".join(["frictionjoint", *parts]))
    return dict(sorted(compiled.registry.items()))


def build(folder: Path, target: str | None = None) -> Path:
    """Translate all kernels and compile them into a folder.

    A library of the same source that is already in the folder is kept.

    Args:
        target: see `compiler.TARGETS`; None: this machine.
    Returns:
        path of the library.
    Raises:
        ModelError: a kernel cannot be translated. RuntimeError: the C text cannot be compiled.
    """
    stamps = library.stamps(library.sources())
    text, listed = unit(all_kernels())
    digest = hashlib.sha256(f"{FLAGS}{text}".encode()).hexdigest()[:12]
    folder.mkdir(parents=True, exist_ok=True)
    made = next(folder.glob(f"kernels-{digest}.*"), None)
    if made is None or target is not None:
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            source = Path(scratch) / "kernels.c"
            source.write_text(text, encoding="utf-8")
            fresh = compile_library(source, Path(scratch), f"kernels-{digest}", target)
            made = folder / fresh.name
            os.replace(fresh, made)
    said = {"library": made.name, "sources": stamps, "kernels": listed}
    with tempfile.NamedTemporaryFile("w", dir=folder, delete=False, encoding="utf-8") as held:
        json.dump(said, held, separators=(",", ":"))
    os.replace(held.name, folder / library.LISTED)
    for old in folder.glob("kernels-*"):
        if old.name != made.name:
            old.unlink(missing_ok=True)
    return made


if __name__ == "__main__":
    build(Path(sys.argv[1]), *sys.argv[2:3])
