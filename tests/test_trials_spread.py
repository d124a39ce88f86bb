"""Blind trials over a Dask cluster of processes: the answers of one's own; and taken up again."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"


def trials(out, *options):
    command = [sys.executable, str(SCRIPTS / "blind_trials.py"), "--trials", "2", "--seed", "239"]
    command += ["--kind", "none", "--jobs", "2", "--out", str(out), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    found = json.loads((out / "results.json").read_text())
    for trial in found["trials"]:
        del trial["seconds"]
    return found


def test_a_cluster_gives_what_processes_give(tmp_path):
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(processes=True, **options) as cluster:
        spread = trials(tmp_path / "spread", "--scheduler", cluster.scheduler_address)
    assert spread == trials(tmp_path / "here")
    rows = tmp_path / "here" / "trials.jsonl"
    first = rows.read_text()
    assert spread == trials(tmp_path / "here"), "finished trials are taken up, not run again"
    assert rows.read_text() == first
    assert [trial["seed"] for trial in spread["trials"]] == [239000, 239001]
