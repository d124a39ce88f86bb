"""Ended at any moment, or on a full disk, the loop leaves its output whole or absent."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from test_cli import LOG, MODEL

from frictionjoint.errors import FrictionJointError
from frictionjoint.report.write import write_files

EXIT = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -9}
REPORT = {"report.json", "report.html", "model.xml"}


def start(folder: Path) -> subprocess.Popen[str]:
    """The loop on a shipped log, writing into `folder`/out."""
    arguments = ["close-loop", str(LOG), "--model", str(MODEL)]
    # a job in the background inherits an ignored SIGINT, which Python and the command then respect
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from frictionjoint.cli import main; main()"
    )
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.Popen(
        [*command, "--joint", "joint", "--out", "out"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("number", EXIT, ids=lambda n: n.name)
def test_loop_killed_at_a_random_moment(number, tmp_path):
    process = start(tmp_path)
    try:
        process.wait(random.Random(int(number)).uniform(0.5, 5.0))
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    _, err = process.communicate(timeout=20)
    # before our handlers stand, Python or the system answers the signal
    assert process.returncode in (0, EXIT[number], -number, 1), err
    assert process.returncode != EXIT[number] or "Traceback" not in err
    out = tmp_path / "out"
    if number != signal.SIGKILL:  # which no program sees coming
        assert {path.name for path in tmp_path.iterdir()} <= {"out"}
    if out.exists():
        assert {path.name for path in out.iterdir()} >= REPORT
        json.loads((out / "report.json").read_text())
        assert (out / "report.html").read_text().rstrip().endswith("</html>")
        assert (out / "model.xml").read_text().rstrip().endswith("</mujoco>")


@pytest.mark.parametrize(("number", "code"), [*EXIT.items()][:2])
def test_exit_code_tells_the_signal(number, code, tmp_path):
    process = start(tmp_path)
    until_it_listens(process)
    process.send_signal(number)
    _, err = process.communicate(timeout=90)
    assert process.returncode == code, err
    assert "Traceback" not in err
    assert len(err.strip().splitlines()) <= 1
    assert list(tmp_path.iterdir()) == []


def until_it_listens(process):
    """Until the command has put its own answer to SIGTERM in place."""
    status = Path(f"/proc/{process.pid}/status")
    if not status.exists():
        pytest.skip("no /proc: cannot tell when the command listens")
    end = time.monotonic() + 30
    while time.monotonic() < end and process.poll() is None:
        caught = next(x for x in status.read_text().splitlines() if x.startswith("SigCgt"))
        if int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1:
            return
        time.sleep(0.01)
    pytest.fail("the command never listened")


def test_folder_appears_whole(tmp_path, monkeypatch):
    """At the moment the new folder takes its name all files in it are finished."""
    seen = []
    rename = os.rename

    def watched(source, target):
        seen.append(sorted((p.name, p.read_text()) for p in Path(source).iterdir()))
        rename(source, target)

    monkeypatch.setattr("os.rename", watched)
    write_files(tmp_path / "out", {"a": "1", "b": "2"})
    assert seen == [[("a", "1"), ("b", "2")]]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["a", "b"]


def test_a_full_disk_leaves_nothing(tmp_path):
    """Files may grow to 4 kB only, as on a disk that is full there; one line, nothing written."""
    script = (
        "import resource, signal, sys\n"
        "from pathlib import Path\n"
        "from frictionjoint.errors import FrictionJointError\n"
        "from frictionjoint.report.write import write_files\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "try:\n"
        "    write_files(Path(sys.argv[1]), {'small': 'x', 'large': 'x' * 10000})\n"
        "except FrictionJointError as error:\n"
        "    sys.exit(str(error))\n"
    )
    for out in (tmp_path / "new", tmp_path):
        command = [sys.executable, "-B", "-c", script, str(out)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert done.returncode == 1
        assert "cannot write the result" in done.stderr
        assert list(tmp_path.iterdir()) == []


def test_older_files_stay_where_the_new_ones_cannot_be_written(tmp_path):
    (tmp_path / "a").write_text("old")
    with pytest.raises(FrictionJointError, match="cannot write"):
        write_files(tmp_path, {"a": "new", "missing/b": "new"})
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a", "old")]
