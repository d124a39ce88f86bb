"""Build the shared library of the kernels.

    python -m frictionjoint.translate.build FOLDER [TARGET]

A build imports all modules with kernels. In this process the kernels run as Python
(``FRICTIONJOINT_PYTHON=1``). They become static functions of one C file, so that the compiler can
inline them, and the library exports one wrapper function per kernel. The C compiler is that of the
machine, or the one in the PyPI package ``ziglang``.
"""

import hashlib
import importlib
import importlib.util
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from frictionjoint import compiled, library
from frictionjoint.compiled import is_tuple
from frictionjoint.library import Entry, Parameter
from frictionjoint.translate.c_expressions import Expressions
from frictionjoint.translate.c_functions import Translation
from frictionjoint.translate.kinds import LIBRARY, NOTHING, fields_of, is_structure

# Results equal those of Python: no fused multiply-add, and no reordering.
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared", "-w")
ENDINGS = {"linux": ".so", "macos": ".dylib", "windows": ".dll"}
TARGETS = {
    "linux-x86_64": "x86_64-linux-gnu.2.17",
    "linux-aarch64": "aarch64-linux-gnu.2.17",
    "macos-arm64": "aarch64-macos.11.0",
    "windows-x86_64": "x86_64-windows-gnu",
}
"""What zig compiles for, by the names used here."""
_HEAD = """/* The kernels of frictionjoint, written by frictionjoint.translate. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(_MSC_VER) || defined(_WIN32)
#define FJ_SHARED __declspec(dllexport)
#else
#define FJ_SHARED __attribute__((visibility("default")))
#endif
#define FJ_IN_LINE static inline __attribute__((always_inline))
"""


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
        target: a key of `TARGETS`; None: this machine.
    Returns:
        path of the library.
    Raises:
        ModelError: a kernel cannot be translated. RuntimeError: the C text cannot be compiled.
    """
    stamps = library.stamps(library.sources())
    text, listed = _unit(all_kernels())
    digest = hashlib.sha256(f"{FLAGS}{text}".encode()).hexdigest()[:12]
    folder.mkdir(parents=True, exist_ok=True)
    made = next(folder.glob(f"kernels-{digest}.*"), None)
    if made is None or target is not None:
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            source = Path(scratch) / "kernels.c"
            source.write_text(text, encoding="utf-8")
            fresh = _compile(source, Path(scratch), f"kernels-{digest}", target)
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


def _unit(kernels: Mapping[str, Any]) -> tuple[str, dict[str, Entry]]:
    """C text, and the symbol, result and parameters of each kernel.

    Args:
        kernels: by module and name, see `frictionjoint.compiled.registry`.
    Raises:
        ModelError: a construct that cannot be translated.
    """
    translation = Translation(kernels.values(), dialect=LIBRARY)
    shown: list[str] = []
    listed: dict[str, Entry] = {}
    for name, kernel in kernels.items():
        made = translation.made[kernel.py_func]
        shown.append(_shown(made))
        result = "bool" if made.python.__annotations__["return"] is bool else made.result
        listed[name] = Entry(f"fj_{made.name}_", result, _parameters(made))
    return "\n".join([_HEAD, translation.text(), *shown]) + "\n", listed


def _parameters(made: Expressions) -> tuple[Parameter, ...]:
    found = []
    for name in made.parameters:
        kind = made.kinds[name]
        fields = fields_of(made.structures[kind]) if is_structure(kind) else {}
        axes = sorted(made.axes.get(name, ()))
        found.append(Parameter(name, kind, name in made.written, axes, fields))
    return tuple(found)


def _shown(made: Expressions) -> str:
    """The function that the library exports for a kernel; tuples are passed by address."""
    declared: list[str] = []
    given: list[str] = []
    for name in made.parameters:
        kind = made.kinds[name]
        if is_tuple(kind):
            declared.append(f"const {kind} *{name}_")
            given.append(f"*{name}_")
            continue
        declared.append(f"{LIBRARY.declared(kind)}{name}_")
        given.append(f"{name}_")
        for axis in sorted(made.axes.get(name, ())):
            declared.append(f"int64_t {name}_n{axis}")
            given.append(f"{name}_n{axis}")
    call, result = f"fj_{made.name}({', '.join(given)})", LIBRARY.type_of(made.result)
    if is_tuple(made.result):
        declared.append(f"{made.result} *out_")
        call, result = f"*out_ = {call}", NOTHING
    elif made.result != NOTHING:
        call = f"return {call}"
    head = f"FJ_SHARED {result} fj_{made.name}_({', '.join(declared) or NOTHING})"
    return f"{head};\n{head}\n{{\n    {call};\n}}\n"


def _own_compiler() -> list[str] | None:
    """Command of the installed compiler, preferably the one in ``CC``; None if there is none."""
    asked = os.environ.get("CC")
    if asked:
        return shlex.split(asked)
    found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    return [found] if found else None


def _compile(source: Path, folder: Path, stem: str, target: str | None) -> Path:
    """The shared library of a C file, for a target of `TARGETS` or, if None, this machine."""
    compiler = None if target else _own_compiler()
    if compiler is None:
        if importlib.util.find_spec("ziglang") is None:
            raise RuntimeError("no C compiler: install one, or ziglang from PyPI")
        compiler = [sys.executable, "-m", "ziglang", "cc"]
        compiler += ["-target", TARGETS[target]] if target else []
    here = {"win32": "windows", "darwin": "macos"}.get(sys.platform, "linux")
    name = target.split("-")[0] if target else here
    made = folder / f"{stem}{ENDINGS[name]}"
    flags = [flag for flag in FLAGS if not (flag == "-fPIC" and name == "windows")]
    flags += [] if name == "macos" else ["-s"]  # without symbols that are not needed
    libraries = [] if name == "windows" else ["-lm"]
    command = [*compiler, *flags, str(source), "-o", str(made), *libraries]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{shlex.join(command)} fails:\n{done.stderr[-4000:]}")
    return made


if __name__ == "__main__":
    build(Path(sys.argv[1]), *sys.argv[2:3])
