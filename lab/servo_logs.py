"""Servo logs of target and position through the loop, refined by simulation: closed-loop errors.

    python lab/servo_logs.py --data DIR [--only sts3215] [--held-out "kp 8"] [--write]

STS3215 (K-Scale Labs): each firmware gain held out once, both rigs fitted together; each rig held
out once. XL330 (BAM): each gain held out once. EMPS: the last third of its log. Nothing is trimmed;
single corrupt readings of a position are interpolated, as the reader does for every log. The error
is the mean of |simulated - measured position| over all samples of the logs held out, rad, given the
target alone; of EMPS the rms, mm, and the norm over that of the position, per cent, as its
benchmark has it.

--write puts the rows that were run into the table of lab/notes/servo_logs.md and leaves the rest
of that page as it is.
"""

import argparse
import itertools
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictionjoint import close_loop
from frictionjoint.control import PRESETS
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.closed_loop import LoopErrors
from frictionjoint.report.joint_report import Report

ROOT = Path(__file__).resolve().parents[1]
MODELS = ROOT / "models"
JOINT = "pendulum"
STS3215 = {
    "m0.535*": MODELS / "sts3215_pendulum.xml",
    "m0.969*": MODELS / "sts3215_pendulum_heavy.xml",
}
PAGE = ROOT / "lab/notes/servo_logs.md"
TABLE = """| servo | held out | before | balance | refined | taken | law | found | s |
|---|---|---|---|---|---|---|---|---|
"""
AXIS = """| axis | held out | before | balance | refined | taken | law | found | s |
|---|---|---|---|---|---|---|---|---|
"""
LAST = 1.0 / 3.0


@dataclass(frozen=True)
class Split:
    """One row: logs to fit and logs held out."""

    servo: str
    name: str
    fit: list[JointLog]
    held_out: list[JointLog]

    @property
    def model(self) -> Mapping[str, Path] | Path:
        """MJCF, or one by the names of the logs."""
        if self.servo == "sts3215":
            return STS3215
        return MODELS / ("emps.xml" if self.servo == "emps" else "xl330_pendulum.xml")

    def report(self) -> Report:
        """Fit, refine, simulate."""
        begin, axis = time.perf_counter(), self.servo == "emps"
        return close_loop(
            self.fit,
            self.model,
            "carriage" if axis else JOINT,
            self.held_out,
            controller=MODELS / "emps.controller.toml" if axis else PRESETS[self.servo],
            progress=lambda text: print(f"    {time.perf_counter() - begin:5.0f} s  {text}"),
        )

    def row(self) -> str:
        """A line of the table."""
        worked, axis = time.process_time(), self.servo == "emps"
        r = self.report()
        loops = [*(r.closed_loops or ()), *([r.refined.loops] if r.refined else ())]
        errors = [in_mm(x) if axis else f"{x.mae.held_out:.4f}" for x in loops]
        errors += [""] * (3 - len(errors))
        found = []
        for a in r.added:
            numbers = ", ".join(f"{n} {x.value:.3g}" for n, x in a.parameters.items())
            found.append(f"{a.effect} ({numbers})")
        taken = "yes" if r.refined and r.refined.taken else "no"
        seconds = time.process_time() - worked
        law = r.laws[1].law
        cells = [self.servo, self.name, *errors, taken, law, "; ".join(found), f"{seconds:.0f}"]
        return f"| {' | '.join(cells)} |"


def in_mm(loops: LoopErrors) -> str:
    """rms of the position's error, and its norm over the position's."""
    position = np.concatenate([course.position for course in loops.held_out.courses])
    part = loops.rms.held_out / np.sqrt(np.mean(position**2))
    return f"{1e3 * loops.rms.held_out:.4f} mm, {part:.4%}"


def splits(data: Path) -> Iterator[Split]:
    """All of them."""
    (whole,) = (read_log(path, "carriage") for path in (data / "emps").glob("*.mat"))
    first, last = split_in_time(whole, LAST)
    yield Split("emps", "last third", [first], [last])
    for servo in ("sts3215", "xl330"):
        logs = [read_log(path, JOINT) for path in sorted((data / servo).glob("*.json"))]
        for figure, unit in (("kp", ""), ("mass", " kg")):
            values = sorted({log.metadata[figure] for log in logs})
            for value in values if len(values) > 1 else []:
                held = [log for log in logs if log.metadata[figure] == value]
                kept = [log for log in logs if log.metadata[figure] != value]
                yield Split(servo, f"{figure} {value:g}{unit}", kept, held)


def into_page(rows: list[str], page: str, head: str) -> str:
    """A page with these rows in its table, in place of earlier ones of the same splits."""
    if not rows:
        return page
    before, table, after = page.partition(head)
    if not table:
        raise SystemExit(f"{PAGE.name}: it has no table of servos, put its two head lines back")
    lines = after.splitlines(keepends=True)
    old = list(itertools.takewhile(lambda line: line.startswith("|"), lines))
    known = {split_of(row): row for row in (*old, *(f"{row}\n" for row in rows))}
    return before + table + "".join(known.values()) + "".join(lines[len(old) :])


def split_of(row: str) -> tuple[str, ...]:
    """Servo and split of a row."""
    return tuple(cell.strip() for cell in row.split("|")[1:3])


def main() -> None:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", action="append", help="a servo; may be repeated")
    parser.add_argument("--held-out", action="append", help="a split, as 'kp 8'; may be repeated")
    parser.add_argument("--write", action="store_true", help="write lab/notes/servo_logs.md")
    asked = parser.parse_args()
    lines: dict[str, list[str]] = {TABLE: [], AXIS: []}
    for split in splits(asked.data):
        if asked.only and split.servo not in asked.only:
            continue
        if asked.held_out and split.name not in asked.held_out:
            continue
        print(split.servo, split.name, flush=True)
        row = split.row()
        print(row, flush=True)
        lines[AXIS if split.servo == "emps" else TABLE].append(row)
    if asked.write:
        page = PAGE.read_text()
        for head, rows in lines.items():
            page = into_page(rows, page, head)
        PAGE.write_text(page)


if __name__ == "__main__":
    main()
