"""What importing, simulating and the help load, and that every folder of code is packaged."""

import ast
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import frictionjoint
from frictionjoint.errors import ParameterError
from frictionjoint.law.names import LAWS
from frictionjoint.laws import parameters_from_dict
from frictionjoint.simulate.stick_slip import kuka_model


def printed(script: str) -> str:
    """What a process of its own prints."""
    command = [sys.executable, "-c", script]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def modules(script: str) -> set[str]:
    """Top-level modules that a process of its own has loaded at the end of a script."""
    ending = "; import sys; print('\\n'.join({m.partition('.')[0] for m in sys.modules}))"
    return set(printed(script + ending).split())


def test_the_import_leaves_heavy_libraries_alone():
    heavy = {"numba", "pandas", "sklearn", "scipy", "mujoco", "matplotlib", "pyarrow"}
    assert not modules("import frictionjoint") & heavy


def test_every_folder_of_code_is_packaged():
    root = Path(__file__).resolve().parents[1]
    settings = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["setuptools"]
    files = (root / "frictionjoint").rglob("__init__.py")
    folders = {".".join(file.parent.relative_to(root).parts) for file in files}
    assert folders | {"frictionjoint.models"} == set(settings["packages"])
    assert Path(frictionjoint.__file__).with_name("py.typed").is_file()


def test_a_simulation_loads_no_readers_no_plots_and_no_command_line():
    loaded = modules(
        f"import frictionjoint as fj; m = fj.load_model({str(kuka_model())!r}); fj.attach(m)"
    )
    unwanted = {"scipy", "pyarrow", "matplotlib", "pandas", "jinja2", "pooch", "typer", "rich"}
    assert not loaded & unwanted


@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="memory is read from /proc")
def test_a_loaded_model_takes_at_most_120_megabytes():
    status = printed(
        f"import frictionjoint as fj; fj.load_model({str(kuka_model())!r}); "
        "print(open('/proc/self/status').read())"
    )
    kilobytes = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    assert int(kilobytes.split()[1]) < 120_000


def test_the_help_loads_neither_numpy_nor_mujoco():
    loaded = modules(
        "import typer.testing as t, frictionjoint.cli as c; "
        "assert t.CliRunner().invoke(c.app, ['--help']).exit_code == 0"
    )
    assert not loaded & {"numpy", "mujoco", "numba", "scipy", "importlib.metadata"}


def test_every_law_with_a_name_has_its_class():
    with pytest.raises(ParameterError) as refused:
        parameters_from_dict({"law": "none"})
    assert tuple(str(refused.value).rpartition("known are ")[2].split(", ")) == LAWS


def imported_by_part() -> dict[str, set[str]]:
    """For each folder, and each module outside folders, those that it imports."""
    root = Path(frictionjoint.__file__).parent
    parts: dict[str, set[str]] = {}
    for path in root.rglob("*.py"):
        if path == root / "__init__.py":
            continue
        part = path.relative_to(root).with_suffix("").parts[0]
        found = parts.setdefault(part, set())
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                names = [f"{node.module}.{alias.name}" for alias in node.names]
            elif isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                continue
            found |= {x.split(".")[1] for x in names if x.startswith("frictionjoint.")} - {part}
    return parts


def test_folders_import_each_other_in_one_direction_only():
    parts = imported_by_part()
    assert {"measured", "law", "identify", "robot", "cli"} <= set(parts)
    try:
        order = list(TopologicalSorter(parts).static_order())
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))
    layers = ["measured", "identify", "refine", "report", "diagnose", "robot", "commands", "cli"]
    assert sorted(layers, key=order.index) == layers
