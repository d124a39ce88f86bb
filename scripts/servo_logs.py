"""Servo logs of target and position through the loop, refined by simulation: closed-loop errors.

    python scripts/servo_logs.py --data DIR [--only sts3215 --only xl330] [--gains 8] [--docs]

STS3215 (K-Scale Labs): each firmware gain held out once, both rigs fitted together; each rig held
out once. XL330 (BAM): each gain held out once. Nothing is trimmed; single corrupt readings of a
position are interpolated, as the reader does for every log. The error is the mean of
|simulated - measured position| over all samples of the logs held out, rad, given the target alone.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from frictionjoint import close_loop
from frictionjoint.control import PRESETS
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

ROOT = Path(__file__).resolve().parents[1]
MODELS = ROOT / "models"
STS3215 = {
    "m0.535*": MODELS / "sts3215_pendulum.xml",
    "m0.969*": MODELS / "sts3215_pendulum_heavy.xml",
}
HEAD = """# Servo logs

Written by `python scripts/servo_logs.py --data DIR --docs`. Mean absolute position error of whole
logs simulated from their target alone, rad, on logs used for neither the fit nor the choice:
before (friction law alone), by the balance of torques, refined by simulation.

| servo | held out | before | balance | refined | taken | found | s |
|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Split:
    """One row: logs to fit and logs held out."""

    servo: str
    name: str
    fit: list[JointLog]
    held_out: list[JointLog]

    def row(self) -> str:
        """Fit, refine, simulate."""
        begin = time.perf_counter()
        model = STS3215 if self.servo == "sts3215" else MODELS / "xl330_pendulum.xml"
        r = close_loop(
            self.fit,
            model,
            "pendulum",
            self.held_out,
            controller=PRESETS[self.servo],
            refine=True,
            progress=lambda text: print(f"    {time.perf_counter() - begin:5.0f} s  {text}"),
        )
        errors = ["", "", ""]
        if r.closed_loops:
            errors[:2] = [f"{x.mae.held_out:.4f}" for x in r.closed_loops]
        if r.refined:
            errors[2] = f"{r.refined.loops.mae.held_out:.4f}"
        found = []
        for a in r.added:
            numbers = ", ".join(f"{n} {x.value:.3g}" for n, x in a.parameters.items())
            found.append(f"{a.effect} ({numbers})")
        taken = "yes" if r.refined and r.refined.taken else "no"
        seconds = time.perf_counter() - begin
        cells = [self.servo, self.name, *errors, taken, "; ".join(found), f"{seconds:.0f}"]
        return f"| {' | '.join(cells)} |"


def splits(data: Path) -> Iterator[Split]:
    """All of them."""
    for servo in ("sts3215", "xl330"):
        logs = [read_log(path, "pendulum") for path in sorted((data / servo).glob("*.json"))]
        for figure, unit in (("kp", ""), ("mass", " kg")):
            values = sorted({log.metadata[figure] for log in logs})
            for value in values if len(values) > 1 else []:
                held = [log for log in logs if log.metadata[figure] == value]
                kept = [log for log in logs if log.metadata[figure] != value]
                yield Split(servo, f"{figure} {value:g}{unit}", kept, held)


def main() -> None:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", action="append", help="a servo; may be repeated")
    parser.add_argument("--held-out", action="append", help="a split, as 'kp 8'; may be repeated")
    parser.add_argument("--docs", action="store_true", help="write docs/servo_logs.md")
    asked = parser.parse_args()
    lines = []
    for split in splits(asked.data):
        if asked.only and split.servo not in asked.only:
            continue
        if asked.held_out and split.name not in asked.held_out:
            continue
        print(split.servo, split.name, flush=True)
        lines.append(split.row())
        print(lines[-1], flush=True)
    if asked.docs:
        (ROOT / "docs/servo_logs.md").write_text(HEAD + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
