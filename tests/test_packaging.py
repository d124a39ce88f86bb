"""What the package promises to who installs it: a light import, its types, its command."""

import subprocess
import sys
import tomllib
from importlib import resources
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
HEAVY = ("numba", "pandas", "sklearn", "scipy", "mujoco", "matplotlib", "pyarrow")


def python(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=60
    )


@pytest.mark.parametrize("module", HEAVY)
def test_the_import_leaves_heavy_libraries_alone(module):
    done = python("-c", f"import sys, frictionjoint; sys.exit({module!r} in sys.modules)")
    assert done.returncode == 0, done.stderr or f"{module} was imported"


def test_types_ship():
    assert (resources.files("frictionjoint") / "py.typed").is_file()


def test_every_folder_of_code_is_packaged():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {
        ".".join(file.parent.relative_to(ROOT).parts)
        for file in (ROOT / "frictionjoint").rglob("__init__.py")
    }
    assert folders | {"frictionjoint.models"} == set(settings["packages"])
