"""End ``frictionjoint close-loop`` at random moments and look at what it leaves.

    python lab/kill_loop.py [RUNS] [SEED]

Signals in turn: SIGINT, SIGTERM, SIGKILL. After each the folder must be whole or absent, and, but
for SIGKILL, which no program sees coming, nothing else may be left next to it. The run must end
within seconds of the signal and say by its exit code what happened. Half of the runs write over an
older report, which must stay readable.
"""

import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
EXIT = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -9}
_REPORT = ("report.json", "report.html", "model.xml")
_DEMO = Path(str(files("frictionjoint"))) / "demo"
_PATIENCE_S = 20.0


def start(folder: Path) -> subprocess.Popen[str]:
    """The loop on a shipped log, writing into `folder`/out."""
    arguments = ["close-loop", str(_DEMO / "ramps.csv"), "--model", str(_DEMO / "joint.xml")]
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


def kill_once(folder: Path, after_s: float, number: signal.Signals) -> str | None:
    """Run, end, inspect; what is wrong, or None. The report of an earlier run may lie there."""
    before = (folder / "out" / "report.json").exists()
    process = start(folder)
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    try:
        _, err = process.communicate(timeout=_PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return f"still running {_PATIENCE_S:g} s after {number.name}"
    code = process.returncode
    # before our handlers stand, Python or the system answers the signal
    if code not in (0, EXIT[number], -number, 1):
        return f"{number.name}: exit code {code}: {err[-300:]}"
    if code == EXIT[number] and "Traceback" in err:
        return f"{number.name}: {err[-300:]}"
    return _left(folder, before, number)


def _left(folder: Path, before: bool, number: signal.Signals) -> str | None:
    out = folder / "out"
    names = sorted(p.name for p in folder.iterdir()) + (
        sorted(p.name for p in out.iterdir()) if out.exists() else []
    )
    strange = [n for n in names if n != "out" and n not in _REPORT]
    if strange and number != signal.SIGKILL:
        return f"{number.name}: left {strange}"
    if not out.exists():
        return f"{number.name}: the older report is gone" if before else None
    missing = [n for n in _REPORT if not (out / n).is_file()]
    if missing:
        return f"{number.name}: {out} lacks {missing}"
    json.loads((out / "report.json").read_text())
    if not (out / "report.html").read_text().rstrip().endswith("</html>"):
        return f"{number.name}: report.html is incomplete"
    if not (out / "model.xml").read_text().rstrip().endswith("</mujoco>"):
        return f"{number.name}: model.xml is incomplete"
    return None


def main() -> None:
    """Many runs; one line each, and a summary."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    rng = random.Random(int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    wrong = 0
    with tempfile.TemporaryDirectory() as older, tempfile.TemporaryDirectory() as probe:
        begin = time.perf_counter()
        start(Path(probe)).communicate()
        whole = time.perf_counter() - begin
        print(f"an undisturbed run takes {whole:.1f} s", flush=True)
        for i in range(runs):
            # every third moment is close to the end, where files are written
            moment = rng.uniform(0.0, whole) if i % 3 else rng.uniform(0.9, 1.02) * whole
            number = SIGNALS[(i // 3) % 3]
            with tempfile.TemporaryDirectory() as fresh:
                fault = kill_once(Path(older if i % 2 else fresh), moment, number)
            wrong += fault is not None
            print(
                f"{i}: {number.name} after {moment:.2f} s: {fault or 'whole or absent'}", flush=True
            )
            for left in Path(older).glob("**/.frictionjoint-*"):
                for file in left.iterdir():
                    file.unlink()
                left.rmdir()
    print(f"{runs} runs, {wrong} wrong")
    raise SystemExit(wrong > 0)


if __name__ == "__main__":
    main()
