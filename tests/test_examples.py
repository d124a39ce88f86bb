"""The example scripts run as a reader would run them, and print what they promise."""

import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

import frictionjoint as fj
from tests import command_line

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
NUMBER = r"(-?[\d.]+(?:e[-+]?\d+)?)"


def call(name: str, folder: Path, gl: str, *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments],
        cwd=folder,
        env=os.environ | {"MUJOCO_GL": gl, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        timeout=120,
    )


def run(name: str, folder: Path, *arguments: str) -> str:
    done = call(name, folder, "disable", *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(line: str, text: str) -> list[float]:
    """The numbers on the line that begins so."""
    (found,) = re.findall(rf"^{line}(.*)$", text, re.MULTILINE)
    return [float(x) for x in re.findall(NUMBER, found)]


def test_five_lines_hold_the_arm_that_frictionloss_lets_creep(tmp_path):
    text = run("five_lines", tmp_path)
    ours, native = numbers("frictionjoint", text), numbers("frictionloss", text)
    assert all(abs(x) < most for x, most in zip(ours, (0.3, 1e-9), strict=True))
    assert all(abs(x) > least for x, least in zip(native, (10.0, 1.0), strict=True))


def test_a_log_becomes_a_model_that_replays_better(tmp_path):
    text = run("log_to_model", tmp_path, "--out", "joint.xml")
    (without,) = numbers("error after 0.5 s without friction", text)
    (with_friction,) = numbers("error after 0.5 s with friction", text)
    assert abs(with_friction) < 0.2 * abs(without)
    assert "frictionjoint:joint" in (tmp_path / "joint.xml").read_text()


def test_the_hidden_effect_of_the_shipped_log_is_named(demo_report, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(fj, "close_loop", lambda *given, **more: asked.append(more) or demo_report)
    runpy.run_path(str(EXAMPLES / "what_is_hidden.py"), run_name="__main__")
    text = capsys.readouterr().out
    assert [path.stem for path in asked[0]["held_out"]] == ["multisine"]
    assert "hidden: position-periodic" in text
    before, after = numbers("torque error on the held-out log:", text)
    assert after < 0.4 * before


def test_a_batch_sticks_longer_where_it_breaks_away_later(tmp_path):
    text = run("thousand_joints", tmp_path, "--joints", "64", "--seconds", "3")
    shares = [float(x) for x in re.findall(r"(\d+)% of the time", text)]
    assert len(shares) == 4
    assert sorted(shares) == shares
    assert shares[0] > 0


def test_stick_slip_is_filmed(tmp_path):
    imageio = pytest.importorskip("imageio.v3")
    arguments = ("--duration", "0.2", "--video", "film.gif")
    for gl in ("egl", "osmesa"):
        done = call("stick_slip", tmp_path, gl, *arguments)
        if done.returncode == 0:
            break
    else:
        assert "no video: " in done.stderr
        pytest.skip(f"no OpenGL off screen here: {done.stderr.strip()}")
    frames = imageio.imread(tmp_path / "film.gif")
    assert frames.shape == (5, 540, 960, 3)
    assert frames[0].std() > 20, "the picture is blank"


def test_gymnasium_environment_with_and_without_friction(tmp_path):
    pytest.importorskip("gymnasium")
    text = run("gym_joint", tmp_path, "--seconds", "5")
    tracking_error_grows(text)
    (one,) = numbers("frictionjoint", text)
    assert numbers("four at once", text) == pytest.approx([one] * 4, abs=0.06)


def test_dm_control_task_with_and_without_friction(tmp_path):
    if int(mujoco.__version__.split(".")[0]) >= 4:
        pytest.skip("dm_control 1.0.50 does not import on MuJoCo 4")
    pytest.importorskip("dm_control")
    tracking_error_grows(run("dm_control_joint", tmp_path, "--seconds", "5"))


def tracking_error_grows(text: str) -> None:
    names = "no friction", "frictionloss", "frictionjoint"
    (free,), (native,), (ours,) = (numbers(name, text) for name in names)
    assert free < native < ours


def test_sysid_finds_a_joint_made_with_another_law(tmp_path):
    sysid = pytest.importorskip("mujoco.sysid")
    if not hasattr(sysid, "optimize"):
        pytest.skip("mujoco.sysid lacks its dependencies: install mujoco[sysid]")
    text = run("sysid_joint", tmp_path)
    # the plant is Maxwell-slip: what the two laws share comes back
    for name, tolerance in (("Fc", 0.02), ("Fs", 0.03), ("sigma2", 0.1), ("kp", 0.02)):
        true, started, found = numbers(rf"{name} ", text)
        assert found == pytest.approx(true, rel=tolerance), name
        assert abs(found - true) < 0.5 * abs(started - true), name


def test_the_tutorial_shows_what_its_command_prints(tmp_path):
    page = (EXAMPLES.parent / "docs/tutorial.md").read_text()
    command = re.search(r"^frictionjoint (close-loop .*?)```", page, re.MULTILINE | re.DOTALL)[1]
    shutil.copytree(EXAMPLES / "recording", tmp_path / "recording")
    done = command_line.run(*command.replace("\\\n", " ").split(), cwd=tmp_path / "recording")
    # numbers may differ between versions of MuJoCo
    shown, printed = (re.sub(r"-?\d[\d.]*|\s+", "_", x) for x in (page, done.stdout))
    assert printed in shown


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda p: p.stem)
def test_a_notebook_runs(path, tmp_path):
    shutil.copytree(EXAMPLES / "recording", tmp_path / "recording")
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=300, resources=place).execute()
    cells = [c for c in notebook.cells if c.cell_type == "code"]
    assert all(c.execution_count for c in cells)
    assert any("text/html" in o.get("data", {}) for c in cells for o in c.outputs)
    assert any("image/png" in o.get("data", {}) for o in cells[-1].outputs), "it ends with a plot"
