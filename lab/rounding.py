"""What rounding decides of real logs: each joint as measured, and with its torque changed by 1e-9.

    python lab/rounding.py --data DIR [--only panda --only ur10] [--jobs 2]

A row a joint of `real_logs.py`: names and held-out error of both, and whether they are the same. A
torque that differs by a billionth, at random from sample to sample, holds the same information; two
machines differ by no more than the rounding that this stands for.
"""

import argparse
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from real_logs import ROOT, Case, cases

from frictionjoint import close_loop
from frictionjoint.measured.log import JointLog

_CHANGE = 1e-9


def changed(log: JointLog, rng: np.random.Generator) -> JointLog:
    """The log with another torque, voltage or current, by a billionth."""
    factor = 1.0 + _CHANGE * rng.standard_normal(len(log.time))
    drives = {name: getattr(log, name) for name in ("torque", "voltage", "current")}
    return replace(log, **{name: x * factor for name, x in drives.items() if x is not None})


def row(case: Case) -> str:
    """A line of the table."""
    rng = np.random.default_rng(1)
    measured, held_out = case.read()
    cells = []
    for logs in (measured, [changed(log, rng) for log in measured]):
        r = close_loop(logs, ROOT / f"models/{case.model}.xml", case.joint, held_out)
        names = ", ".join(added.effect for added in r.added) or "none"
        cells.append((names, f"{(r.after_torque.held_out or 0.0) / r.measured_rms:.3%}"))
    (names, error), (others, other) = cells
    alike = {"names": names == others, "error": error == other}
    same = ", ".join(what for what, is_so in alike.items() if is_so)
    return f"| {case.machine} | {case.joint} | {names} {error} | {others} {other} | {same} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", action="append", help="a machine; may be repeated")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    asked = parser.parse_args()
    chosen = [c for c in cases(asked.data) if not asked.only or c.machine in asked.only]
    print("| machine | joint | as measured | changed by 1e-9 | same |\n|---|---|---|---|---|")
    with ProcessPoolExecutor(asked.jobs) as pool:
        for line in pool.map(row, chosen):
            print(line, flush=True)


if __name__ == "__main__":
    main()
