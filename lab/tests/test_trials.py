"""Trials write a row a plant, go on from there, and show what could not be run."""

import json
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "lab" / "trials.py"
MODEL = (
    '<mujoco><worldbody><body><joint name="joint1"/><inertial mass="1" pos="0 0 0" '
    'diaginertia="1 1 1"/></body></worldbody></mujoco>'
)


def trials(*arguments):
    command = [sys.executable, str(SCRIPT), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def plant(folder):
    folder.mkdir(parents=True)
    (folder / "model.xml").write_text(MODEL)
    for name in ("fit1", "held"):
        (folder / f"{name}.csv").write_text("time_s,position_rad\n0,0\n")
    (folder / "answer.json").write_text(json.dumps({"kind": "spring", "noise": 0.1}))


def test_a_row_a_plant_and_no_plant_twice(tmp_path):
    plant(tmp_path / "plants" / "000")
    out = tmp_path / "rows.jsonl"
    first = trials(tmp_path / "plants", "--jobs", "1", "--out", out)
    assert first.returncode == 0, first.stderr
    (row,) = map(json.loads, out.read_text().splitlines())
    assert row["plant"] == str(tmp_path / "plants" / "000")
    assert row["error"].startswith("LogError: ")
    assert row["error"].splitlines()[0] in first.stdout
    again = trials("--out", out)
    assert again.returncode == 0, again.stderr
    assert len(out.read_text().splitlines()) == 1
    assert "second hand: 1 plants" in again.stdout
    assert "ended with an error: 1" in again.stdout


def test_a_folder_without_plants_is_refused(tmp_path):
    done = trials(tmp_path, "--out", tmp_path / "rows.jsonl")
    assert done.returncode != 0
    assert f"{tmp_path}: no plants" in done.stderr
