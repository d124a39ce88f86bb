"""Time and memory of the base fit and of the whole loop, next to those of an earlier commit.

    python scripts/benchmark_loop.py --against 645f3a0
    python scripts/benchmark_loop.py --against 645f3a0 --data DIR     XL330 and EMPS too
    python scripts/benchmark_loop.py --seconds 15 --cores 2 --json

A log at 1 kHz of a test joint of `lab/plants` with generalized Maxwell-slip friction and cogging;
of the XL330 the logs at kp 400 held out, of EMPS the last third. Every measurement has a process of
its own, held to its cores, and so a peak memory of its own, libraries included. The earlier commit
is taken out of git into a temporary folder; both read the same files, in turns. What is
loaded late is loaded on a short piece of the log before the clock starts.
"""

import argparse
import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
# s of a log on which kernels are compiled
_SHORT = 6.0
_XL330_HELD_OUT = 400


class Case(NamedTuple):
    """Logs of one joint; held_out: files, or the fraction of each log's end."""

    name: str
    model: str
    joint: str
    logs: list[str]
    held_out: list[str] | float


def made(seconds: float, folder: Path) -> Case:
    """A joint with a load on a lever and cogging, led by a multisine, then by ramps."""
    sys.path.append(str(Path(__file__).resolve().parents[1] / "lab"))  # plants
    from plants.plant import simulate, write
    from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

    spec = PlantSpec(
        mass=1.0,
        length=0.2,
        inertia=0.06,
        armature=0.02,
        friction=Friction("gms", Fs=0.8, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3),
        controller=Controller(kp=60.0, kd=3.0),
        motions=(
            Motion("multisine", 3, 0.8, 2.0, seconds / 2),
            Motion("ramps", 4, 0.8, 1.0, seconds / 2),
        ),
        instrument=Instrument(rate=1000.0, counts=2**20, torque_noise=0.01),
        seed=1,
        effects=(Effect("position-periodic", {"amplitude": 0.1, "cycles": 9.0, "phase": 0.4}),),
    )
    logs = [str(path) for path in write(simulate(spec), folder)]
    return Case(f"{seconds:g} s at 1 kHz", str(folder / "joint.xml"), "joint", logs, 0.25)


def measured(data: Path) -> list[Case]:
    """The XL330 and EMPS of a data folder."""
    xl330 = sorted((data / "xl330").glob("*.json"))
    held = [p for p in xl330 if json.loads(p.read_text())["kp"] == _XL330_HELD_OUT]
    models = ROOT / "models"
    emps = [str(data / "emps/DATA_EMPS.mat")]
    return [
        Case("XL330", str(models / "xl330_pendulum.xml"), "pendulum",
             [str(p) for p in xl330 if p not in held], [str(p) for p in held]),
        Case("EMPS", str(models / "emps.xml"), "carriage", emps, 1 / 3),
    ]  # fmt: skip


def measure(case: Case) -> dict[str, Any]:
    """Seconds of the base fit and of the loop, MB at the peak, what was found.

    Uses what the package has offered in every version.
    """
    import frictionjoint
    from frictionjoint import close_loop
    from frictionjoint.errors import FrictionJointError
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.rigid_body import RigidBody
    from frictionjoint.measured.log import split_in_time
    from frictionjoint.measured.readers import read_log

    try:
        from frictionjoint.identify.starts import fit
    except ImportError:  # where it was before
        from frictionjoint.identify.fit import fit

    logs = [read_log(path, case.joint) for path in case.logs]
    held_out = case.held_out
    if not isinstance(held_out, float):
        held_out = [read_log(path, case.joint) for path in held_out]
    first = logs[0]
    if first.duration > _SHORT:
        first, _ = split_in_time(first, 1.0 - _SHORT / first.duration)
    # what a short piece does not reach is compiled within the time measured
    with contextlib.suppress(FrictionJointError):
        close_loop([first], case.model, case.joint)
    body = RigidBody(case.model, case.joint)
    fit(prepare(logs, body))
    prepared = prepare(logs, body)  # logs may remember what a fit made of them
    begin = time.perf_counter()
    fit(prepared)
    base = time.perf_counter() - begin
    begin = time.perf_counter()
    report = close_loop(logs, case.model, case.joint, held_out)
    return {
        "base_fit_s": base,
        "loop_s": time.perf_counter() - begin,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "added": [added.effect for added in report.added],
        "held_out_rms": report.after_torque.held_out,
        "package": str(Path(frictionjoint.__file__).parents[1]),
    }


def in_a_process(case: Case, tree: Path, cores: int, cache: Path) -> dict[str, Any]:
    """`measure` by the package of a tree, on so many cores."""
    own = {"PYTHONPATH": str(tree), "FRICTIONJOINT_THREADS": str(cores)}
    command = [sys.executable, __file__, "--measure", json.dumps(case), "--cores", str(cores)]
    done = subprocess.run(
        command, env=os.environ | own, cwd=cache, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{case.name}, {tree}: {done.stderr}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    if Path(found["package"]) != tree:
        sys.exit(f"measured the package in {found['package']} in place of {tree}")
    return found


def taken_out(commit: str, folder: Path) -> Path:
    """The package as it was at a commit."""
    folder.mkdir()
    archive = subprocess.run(
        ["git", "archive", commit, "frictionjoint"], cwd=ROOT, capture_output=True, check=False
    )
    if archive.returncode:
        sys.exit(archive.stderr.decode())
    subprocess.run(["tar", "-x"], cwd=folder, input=archive.stdout, check=True)
    build = (
        "from pathlib import Path; from frictionjoint.translate.build import build; "
        "build(Path('frictionjoint/_native'), None)"
    )
    own = {"PYTHONPATH": str(folder), "FRICTIONJOINT_PYTHON": "1"}
    subprocess.run([sys.executable, "-c", build], cwd=folder, env=os.environ | own, check=True)
    return folder


def row(name: str, cores: int, now: dict[str, Any], then: dict[str, Any] | None) -> str:
    """A line of the table: with an earlier commit then, now, and how many times less."""
    cells = [name, str(cores)]
    for key, unit in (("base_fit_s", "s"), ("loop_s", "s"), ("peak_mb", "MB")):
        form = "{:.0f} {}" if unit == "MB" else "{:.1f} {}"
        cell = form.format(now[key], unit)
        if then:
            ratio = then[key] / now[key]
            cell = f"{form.format(then[key], unit)} to {cell} ({ratio:.1f} times less)"
        cells.append(cell)
    cells.append(", ".join(now["added"]) or "none")
    if then:
        cells.append(", ".join(then["added"]) or "none")
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seconds", type=float, nargs="+", default=[60.0])
    parser.add_argument("--cores", type=int, nargs="+", default=[2, 1])
    parser.add_argument("--against", metavar="COMMIT", help="an earlier commit")
    parser.add_argument("--data", type=Path, help="folder that holds xl330 and emps")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.measure:
        # before its threads are counted
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: asked.cores[0]])
        print(json.dumps(measure(Case(*json.loads(asked.measure)))))
        return
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cases = [made(seconds, folder / f"{seconds:g}") for seconds in asked.seconds]
        cases += measured(asked.data.resolve()) if asked.data else []
        trees = {"now": ROOT}
        if asked.against:
            trees["then"] = taken_out(asked.against, folder / "then")
        for case in cases:
            for cores in asked.cores:
                found = {"case": case.name, "cores": cores}
                for when, tree in trees.items():
                    cache = folder / f"run-{when}"
                    cache.mkdir(exist_ok=True)
                    found[when] = in_a_process(case, tree, cores, cache)
                rows.append(found)
    if asked.json:
        print(json.dumps(rows, indent=2))
        return
    then = " then" if asked.against else ""
    print(f"{os.cpu_count()} CPUs, load {os.getloadavg()[0]:.1f} at the end\n")
    print("| log | cores | base fit | whole loop | peak memory | added |", end="")
    print(f" added{then} |" if asked.against else "")
    print("|---" * (7 if asked.against else 6) + "|")
    for found in rows:
        print(row(found["case"], found["cores"], found["now"], found.get("then")))


if __name__ == "__main__":
    main()
