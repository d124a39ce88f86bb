"""lab/fuzz.py counts what it tries and lists what fails, crashes included."""

import subprocess
import sys
from pathlib import Path

import pytest

LAB = Path(__file__).resolve().parents[1] / "lab"
BROKEN = """
import os
from pathlib import Path
from hypothesis import given, settings
from hypothesis import strategies as st

def never_anything_else(content):
    if content == b"1":
        raise ValueError("one")
    mark = Path(__file__).with_name("crashed")
    if content == b"2" and not mark.exists():
        mark.touch()
        os._exit(11)
    while content == b"3":
        pass

@settings(max_examples=40)
@given(st.sampled_from([b"0", b"1"]))
def test_some(content):
    never_anything_else(content)

@given(st.just(b"2"))
def test_crash(content):
    never_anything_else(content)

@given(st.just(b"3"))
def test_endless(content):
    never_anything_else(content)
"""
RUN = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import fuzz
fuzz._PATIENCE_S = 0.5
if __name__ == "__main__":
    print(fuzz.fuzz("broken", 0, 8, Path(sys.argv[2])))
"""


@pytest.fixture
def broken(tmp_path, monkeypatch):
    (tmp_path / "test_broken_fuzz.py").write_text(BROKEN)
    (tmp_path / "run.py").write_text(RUN)
    paths = [str(tmp_path), *(p for p in sys.path if p)]
    monkeypatch.setenv("PYTHONPATH", ":".join(paths))
    return tmp_path


def test_failures_crashes_and_endless_loops_are_listed_with_their_input(broken):
    done = subprocess.run(
        [sys.executable, "run.py", str(LAB), str(broken)],
        cwd=broken,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "ValueError at " in done.stdout
    assert "'exit code 11'" in done.stdout
    assert "'no end in 0.5 s'" in done.stdout
    kept = {p.read_bytes() for p in broken.glob("broken-*.input")}
    assert kept == {b"1", b"2", b"3"}
