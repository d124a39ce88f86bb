"""Joints side by side: the same numbers in processes and over a cluster, nothing left behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from arms.arm import random_arm
from arms.run import run, write_csv

from frictionjoint.errors import FrictionJointError
from frictionjoint.robot.close_loop import _first
from frictionjoint.robot.explain import Task
from frictionjoint.robot.logs import RobotLogs
from frictionjoint.robot.workers import workers


@pytest.fixture(scope="module")
def tasks(tmp_path_factory) -> list[Task]:
    folder, arm = tmp_path_factory.mktemp("logs"), random_arm(4, 2)
    write_csv(run(arm, 1, 4.0), folder / "a.csv")
    logs = RobotLogs.read([folder / "a.csv"], [], 0.25, arm.believed)
    return [
        Task(n, logs.fit[n], logs.held_out[n], arm.believed, None, 0, None) for n in logs.joints
    ]


def test_a_cluster_gives_the_same_numbers(tasks):
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        workers(1, cluster.scheduler_address) as each,
    ):
        spread = list(each(_first, tasks))
    for one, other in zip(spread, map(_first, tasks), strict=True):
        assert one.name == other.name
        assert np.array_equal(one.fit.beta, other.fit.beta)
        assert np.array_equal(one.fit.residual, other.fit.residual)


def test_no_scheduler_is_one_line(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("frictionjoint.robot.workers._PATIENCE_S", 1)
    with (
        pytest.raises(FrictionJointError, match=r"tcp://127\.0\.0\.1:9: no Dask scheduler"),
        workers(1, "tcp://127.0.0.1:9"),
    ):
        pass


def children(pid: int) -> list[int]:
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        found += [int(child) for child in task.read_text().split()]
    return [*found, *(x for child in found for x in children(child))]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no /proc: no list of processes")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption_ends_all_processes_and_leaves_nothing(tmp_path, number, code):
    arm = random_arm(4, 2)
    write_csv(run(arm, 1, 4.0), tmp_path / "a.csv")
    (tmp_path / "arm.xml").write_text(arm.believed)
    before = sorted(tmp_path.iterdir())
    program = (
        "import signal, os; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from frictionjoint.robot import close_loop\n"
        "close_loop.processes = lambda jobs: 2\n"
        "from frictionjoint.cli import main; main()"
    )
    command = ["close-loop", "a.csv", "--model", "arm.xml", "--out", "out"]
    process = subprocess.Popen(
        [sys.executable, "-c", program, *command], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    end = time.monotonic() + 120.0
    while len(started := children(process.pid)) < 3 and time.monotonic() < end:
        time.sleep(0.05)  # two workers, and what keeps their shared resources
    assert len(started) >= 3
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == code, err
    assert "Traceback" not in err
    assert sorted(tmp_path.iterdir()) == before
    end = time.monotonic() + 20.0
    while any(alive(pid) for pid in started) and time.monotonic() < end:
        time.sleep(0.1)
    assert not any(alive(pid) for pid in started)


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
