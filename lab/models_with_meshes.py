"""Models with meshes through `frictionjoint install`, `check` and a hundred steps.

    python lab/models_with_meshes.py FOLDER [--most 17]

Looks in FOLDER for MJCF and URDF files that name asset files and have joints to put friction on,
one a subfolder, installs the same friction on every hinge and slide with a name, writes the result
far from its source, and prints a table: what was installed, whether the written model has the
meshes and textures of its source, whether `check` reads it, and whether a hundred steps stay finite
and differ from those without friction.
"""

import argparse
import contextlib
import io
import itertools
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.cli import main as frictionjoint
from frictionjoint.errors import FrictionJointError
from frictionjoint.files import toml_text
from frictionjoint.model_files import ONE_DOF, compile_model

# light enough for a finger, and slack enough for the time step of any model
FRICTION = fj.FrictionParameters.symmetric(Fs=0.015, Fc=0.01, Vs=0.05, knots=((0.01, 0.031),))
STEPS = 100
ASSETS = ("mesh_vert", "mesh_face", "tex_data", "hfield_data", "skin_vert")


@dataclass(frozen=True)
class Row:
    """What became of one model."""

    name: str
    joints: int
    meshes: int
    textures: int
    said: str
    seconds: float


def command(*arguments: object) -> str:
    """Run a command of frictionjoint in this process; raises FrictionJointError where it fails."""
    out, err = io.StringIO(), io.StringIO()
    words = ["frictionjoint", *map(str, arguments)]
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        mock.patch.object(sys, "argv", words),
    ):
        try:
            frictionjoint()
        except SystemExit as ended:
            if ended.code:
                raise FrictionJointError(err.getvalue()) from None
    return out.getvalue()


def candidates(folder: Path) -> Iterator[Path]:
    """Files of models with asset files, the first that compiles in each subfolder."""
    found: set[Path] = set()
    for path in sorted([*folder.rglob("*.xml"), *folder.rglob("*.urdf")]):
        if path.parent in found:
            continue
        head = path.read_text(encoding="utf-8", errors="ignore")
        if "<mujoco" not in head and "<robot" not in head:
            continue
        with contextlib.suppress(FrictionJointError):
            model = compile_model(path)
            if (model.nmesh or model.ntex or model.nhfield) and named(model):
                found.add(path.parent)
                yield path


def named(model: mujoco.MjModel) -> list[str]:
    """Hinges and slides with a name."""
    return [
        model.joint(i).name
        for i in range(model.njnt)
        if int(model.jnt_type[i]) in ONE_DOF and model.joint(i).name
    ]


def stepped(model: mujoco.MjModel) -> np.ndarray:
    """Positions after a hundred steps from the first key frame, or from qpos0."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qvel[:] += 0.1
    mujoco.mj_step(model, data, nstep=STEPS)
    return data.qpos.copy()


def tried(path: Path, name: str, folder: Path) -> Row:
    """Install, check, step."""
    begin = time.perf_counter()
    before = compile_model(path)
    joints = named(before)
    parameters, out = folder / "friction.toml", folder / "out" / "deep" / "model.xml"
    parameters.write_text(toml_text(FRICTION))
    options = [word for joint in joints for word in ("--joint", f"{joint}={parameters}")]
    try:
        command("install", path, *options, "--clear-native", "--out", out)
        command("check", out)
        model = fj.load_model(out)
        alike = all(np.array_equal(getattr(model, k), getattr(before, k)) for k in ASSETS)
        free = stepped(model)
        with fj.attach(model):
            rubbed = stepped(model)
        if not alike:
            said = "assets differ"
        elif not np.all(np.isfinite(rubbed)):
            said = "not finite"
        else:
            said = "works" if not np.array_equal(rubbed, free) else "friction does not act"
    except (FrictionJointError, ValueError) as error:
        said = " ".join(str(error).split())[:160]
    seconds = time.perf_counter() - begin
    return Row(name, len(joints), before.nmesh, before.ntex, said, seconds)


def main() -> None:
    """Try them and print the table, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--most", type=int, default=17)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    print(f"MuJoCo {mujoco.__version__}\n")
    print("| model | joints | meshes | textures | install, check, 100 steps | s |")
    print("|---|---|---|---|---|---|")
    rows = []
    for path in itertools.islice(candidates(arguments.folder), arguments.most):
        with tempfile.TemporaryDirectory() as folder:
            name = path.relative_to(arguments.folder).as_posix()
            rows.append(row := tried(path, name, Path(folder)))
        print(
            f"| {row.name} | {row.joints} | {row.meshes} | {row.textures} | {row.said} "
            f"| {row.seconds:.1f} |",
            flush=True,
        )
    works = sum(row.said == "works" for row in rows)
    print(f"\n{works} of {len(rows)} work.")


if __name__ == "__main__":
    main()
