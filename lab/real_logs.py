"""Every measured log of a data folder through the loop: one row per joint.

    python lab/real_logs.py --data DIR [--only emps --only panda] [--write]

Held out: the end of each log in time, one gain of the XL330. Nothing is tuned to a log: each runs
as the command line would run it. A joint that cannot be run takes its error line as its row.
"""

import argparse
import os
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from frictionjoint import close_loop
from frictionjoint.errors import FrictionJointError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

ROOT = Path(__file__).resolve().parents[1]
HEAD = """# Measured logs

Written by `python lab/real_logs.py --data DIR --jobs {jobs} --write` at commit {commit}.
Errors are rms of the torque (force) in motion on held-out data over its rms, with 95%
intervals. The initial state of each held-out log is estimated: friction, and the deflection and
rate of an elastic link. Replay is the rms position error of free runs of half a second, driven by
the measured torque, with its interval over runs.
Before is the integrated law alone, after is the law named with the effects added.
A row whose error is larger after than before is a failure of the loop: what it added held on
the data it was given, and not on the rest. Where the intervals overlap, it may be chance.

"""


@dataclass(frozen=True)
class Case:
    """One joint of one machine."""

    machine: str
    joint: str
    model: str
    logs: tuple[str, ...]
    held_out: tuple[str, ...] | float = 0.3

    def read(self) -> tuple[list[JointLog], list[JointLog] | float]:
        """Its logs, and what is held out of them or next to them."""
        logs = [read_log(path, self.joint) for path in self.logs]
        if isinstance(self.held_out, float):
            return logs, self.held_out
        return logs, [read_log(path, self.joint) for path in self.held_out]


def cases(data: Path) -> Iterator[Case]:
    """What the folder holds."""
    xl330 = sorted((data / "xl330").glob("*.json"))
    gains = {path: read_log(path, "pendulum").metadata["kp"] for path in xl330}
    if xl330:
        fit = tuple(str(p) for p in xl330 if gains[p] != 400)
        yield Case(
            "xl330",
            "pendulum",
            "xl330_pendulum",
            fit,
            tuple(str(p) for p in xl330 if str(p) not in fit),
        )
    yield Case("emps", "carriage", "emps", (str(data / "emps/DATA_EMPS.mat"),), 1 / 3)
    for i in range(1, 8):
        yield Case("panda", f"joint{i}", "panda", (str(data / "panda"),))
    for i in range(1, 7):
        yield Case("ur10", f"j{i}", "ur10", (str(data / "unisa_ur10/ur10.csv"),))
    for i in range(1, 7):
        yield Case("staubli_tx40", f"joint_{i}", "staubli_tx40", (str(data / "staubli_tx40"),))
    for i in range(1, 4):
        logs = tuple(str(data / f"kuka_kr300/{name}.csv") for name in "AB")
        yield Case("kuka_kr300", f"axis{i}", "kuka_kr300", logs)
    odrive = data / "odrive_cogging"
    yield Case("odrive", "rotor", "bldc_motor", (str(odrive / "slow2__nocomp_0.npy"),),
               (str(odrive / "slow2__nocomp_1.npy"),))  # fmt: skip


def row(case: Case) -> str:
    """A line of the table."""
    begin = time.perf_counter()
    try:
        logs, held_out = case.read()
        r = close_loop(logs, ROOT / f"models/{case.model}.xml", case.joint, held_out)
    except FrictionJointError as error:
        return f"| {case.machine} | {case.joint} | {error} | | | | | |"

    def part(value: float | None, stage: int) -> str:
        error = f"{(value or 0.0) / r.measured_rms:.1%}"
        if not r.torque_interval:
            return error
        low, high = (x / r.measured_rms for x in r.torque_interval[stage])
        return f"{error} ({low:.1%} to {high:.1%})"

    def run(value: float | None, interval: tuple[float, ...]) -> str:
        if value is None:
            return "none"
        return f"{value:.2g} ({' to '.join(f'{x:.2g}' for x in interval)})"

    before = part(r.before_torque.held_out, 0)
    after = part(r.after_torque.held_out, 1)
    ends = (r.before_replay.held_out, r.after_replay.held_out)
    replay = ", ".join(map(run, ends, r.replay_interval or ((), ())))
    effects = ", ".join(a.effect for a in r.added) or "none"
    law = r.laws[1].law
    left = ", ".join(name for name, _ in r.unexplained) or "nothing named"
    seconds = time.perf_counter() - begin
    return (
        f"| {case.machine} | {case.joint} | {law} | {effects} | {before} | {after} | {replay} | "
        f"{left} | {seconds:.0f} |"
    )


def main() -> None:
    """Run all, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", action="append", help="a machine; may be repeated")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--write", action="store_true", help="write lab/notes/real_logs.md")
    asked = parser.parse_args()
    commit = subprocess.check_output(("git", "rev-parse", "--short", "HEAD"), text=True).strip()
    chosen = [c for c in cases(asked.data) if not asked.only or c.machine in asked.only]
    lines = [
        "| machine | joint | law | effects added | before | after | replay before, after, rad or m "
        "| unexplained | s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    print("\n".join(lines))
    with ProcessPoolExecutor(asked.jobs) as pool:
        for line in pool.map(row, chosen):
            print(line, flush=True)
            lines.append(line)
    if asked.write:
        (ROOT / "lab/notes/real_logs.md").write_text(
            HEAD.format(jobs=asked.jobs, commit=commit) + "\n".join(lines) + "\n"
        )


if __name__ == "__main__":
    main()
