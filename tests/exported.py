"""What `export` writes of a joint that carries friction, for tests that run it."""

import runpy
from pathlib import Path
from typing import Any

import mujoco

import frictionjoint as fj
from frictionjoint.export.run import export
from frictionjoint.export.targets import Target


def carrying(mjcf: str, law: fj.FrictionParameters, folder: Path) -> Path:
    """The MJCF with friction on its joint `elbow`, as a file."""
    spec = mujoco.MjSpec.from_string(mjcf)
    fj.install(spec, {"elbow": law})
    spec.compile()
    path = folder / "arm.xml"
    path.write_text(spec.to_xml())
    return path


def module_of(path: Path, target: Target, **options: Any) -> dict[str, Any]:
    """What the Python file that is exported of an MJCF defines."""
    file = path.with_name(f"arm_{target}.py")
    file.write_text(export(path, target, file, **options).text)
    return runpy.run_path(str(file))
