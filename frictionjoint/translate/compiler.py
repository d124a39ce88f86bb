"""A C compiler: the one installed on the machine, or the one in the PyPI package ``ziglang``."""

import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

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


def own_compiler() -> list[str] | None:
    """Command of the installed compiler, preferably the one in ``CC``; None if there is none."""
    asked = os.environ.get("CC")
    if asked:
        return shlex.split(asked)
    found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    return [found] if found else None


def compile_library(source: Path, folder: Path, stem: str, target: str | None) -> Path:
    """Compile a C file into a shared library.

    Args:
        folder: for the library. stem: of the library's file name.
        target: a key of `TARGETS`, compiled with zig; None: this machine.
    Raises:
        RuntimeError: there is no compiler, or the compiler rejects the file.
    """
    compiler = None if target else own_compiler()
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
