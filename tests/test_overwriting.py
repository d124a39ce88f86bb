"""No command overwrites what it reads: one line before any work, also with --force."""

import json
import shutil
from importlib.resources import files
from pathlib import Path

import pytest

from frictionjoint.export.targets import FILES
from frictionjoint.motors.bam import BamParameters
from frictionjoint.simulate.stick_slip import kuka_model
from tests.command_line import Done, run
from tests.reports import good

DEMO, MODELS = Path(str(files("frictionjoint.demo"))), kuka_model().parent


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A log, a model and an including one, parameters, and a model that carries them."""
    shutil.copy(DEMO / "ramps.csv", tmp_path / "log.csv")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "controller.toml").write_text('output = "torque_nm"\nkp = 3.0\n')
    (tmp_path / "out" / "report.json").write_text(json.dumps(good()))
    shutil.copy(DEMO / "joint.xml", tmp_path / "out" / "model.xml")
    (tmp_path / "main.xml").write_text('<mujoco><include file="out/model.xml"/></mujoco>')
    shutil.copy(MODELS / "kuka_ir361_joint1.friction.toml", tmp_path / "f.toml")
    shutil.copy(tmp_path / "f.toml", tmp_path / "f.svg")
    made = run("install", "out/model.xml", "--joint", "joint=f.toml", "--out", "own.xml",
               cwd=tmp_path)  # fmt: skip
    assert made.returncode == 0, made.stderr
    friction = {"friction_base": 0.01, "friction_viscous": 0.01}
    bam = BamParameters("m1", "xl330", friction, {"kt": 0.4, "R": 3.0, "armature": 1e-3})
    (tmp_path / "bam.json").write_text(bam.to_json())
    return tmp_path


LOOP = ("close-loop", "log.csv", "--joint", "joint", "--out", "out", "--model")
FIT = ("identify", "log.csv", "--joint", "joint", "--model", "out/model.xml", "--out")
ADD = ("install", "main.xml", "--joint", "joint=f.toml", "--out")
CASES = {
    "close-loop, its model": (*LOOP, "out/model.xml"),
    "close-loop, what its model includes": (*LOOP, "main.xml"),
    "close-loop, its controller": (*LOOP, "main.xml", "--controller", "out/controller.toml"),
    "identify, its log": (*FIT, "log.csv"),
    "identify, one of its files": (*FIT, "f.toml", "--join", "f.toml"),
    "sample, its report": ("sample", "out", "--n", "3", "--out", "out/report.json"),
    "identify, its model": (*FIT, "out/model.xml"),
    "install, its model": (*ADD, "main.xml"),
    "install, what its model includes": (*ADD, "out/model.xml"),
    "install, its parameters": (*ADD, "f.toml"),
    "uninstall": ("uninstall", "own.xml", "--out", "own.xml"),
    "compare": ("compare", "f.svg", "--out", "f.svg"),
    "from-bam": ("motors", "from-bam", "bam.json", "--out", "bam.json"),
    "to-bam, its parameters": ("motors", "to-bam", "f.toml", "--like", "bam.json", "--out",
                               "f.toml"),
    "to-bam, its likeness": ("motors", "to-bam", "f.toml", "--like", "bam.json", "--out",
                             "bam.json"),
    **{f"export to {to}": ("export", "own.xml", "--to", to, "--out", "own.xml") for to in FILES},
}  # fmt: skip


@pytest.mark.parametrize("force", [(), ("--force",)])
@pytest.mark.parametrize("case", CASES)
def test_a_source_is_not_overwritten(case: str, force: tuple[str, ...], home: Path) -> None:
    before = {path: path.read_bytes() for path in home.rglob("*") if path.is_file()}
    done: Done = run(*CASES[case], *force, cwd=home)
    assert done.returncode == 2, done.stdout
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert "is an input of this command" in done.stderr
    assert before == {path: path.read_bytes() for path in home.rglob("*") if path.is_file()}


def test_an_older_result_is_replaced_with_force_only(home: Path) -> None:
    assert run(*ADD, "new.xml", cwd=home).returncode == 0
    older = (home / "new.xml").read_bytes()
    refused = run(*ADD, "new.xml", cwd=home)
    assert refused.returncode == 2
    assert "--force" in refused.stderr
    assert (home / "new.xml").read_bytes() == older
    assert run(*ADD, "new.xml", "--force", cwd=home).returncode == 0
