"""BAM (Rhoban) next to this package on the STS3215 logs, same split and about the same time.

    python lab/compare_with_bam_sts3215.py --data DIR --bam CHECKOUT --bam-python PYTHON
        [--models m1 m2 m3 m4 m5 m6] [--seconds 110] [--gain 8]

--data holds the logs in ``sts3215/``; for --bam and --bam-python see `compare_with_bam.py`. One
firmware gain of both rigs is held out, the others are fitted, nothing is trimmed. Each model of BAM
searches for --seconds of its process and keeps the best that it found. BAM is told the arm's mass
and the supply that the servo reads (12 V), which the logs' own figures leave out or have wrong (15
V); it fits kt, R, armature, the gain of the error, an offset and the largest speed of the target
next to friction.
Errors: mean of |simulated - measured position| of whole logs given the target alone, rad, on BAM's
grid of 5 ms, by motion and over all.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from compare_with_bam import GRID, JOINT, Bam, Row, trajectory
from servo_logs import STS3215

from frictionjoint import close_loop
from frictionjoint.control import PRESETS
from frictionjoint.measured.readers import read_log

# kg, by the tip's mass: as models/README.md has it
ARM = {0.535: 0.036, 0.969: 0.050}
SUPPLY, MANY = 12.0, 10**6
MOTIONS = ("sin_sin", "lift_and_drop", "up_and_down", "sin_time_square", "brutal")


def ours(paths: list[Path], gain: int) -> Row:
    """The loop, refined, on the other gains."""
    logs = {path: read_log(path, JOINT) for path in paths}
    held = {path: log for path, log in logs.items() if log.metadata["kp"] == gain}
    begin = time.process_time()
    fitted = [log for path, log in logs.items() if path not in held]
    report = close_loop(fitted, STS3215, JOINT, list(held.values()), controller=PRESETS["sts3215"])
    seconds = time.process_time() - begin
    assert report.refined
    assert report.closed_loops
    best = report.refined.loops if report.refined.taken else report.closed_loops[-1]
    errors: dict[str, list[float]] = {}
    assert best.held_out
    for path, log, simulated in zip(held, held.values(), best.held_out.simulated, strict=True):
        grid = np.arange(0.0, log.duration, GRID) + log.time[0]
        there, here = (np.interp(grid, log.time, x) for x in (simulated, log.position))
        errors.setdefault(trajectory(path), []).append(float(np.mean(np.abs(there - here))))
    means = {name: float(np.mean(errors[name])) for name in MOTIONS}
    return Row(gain, "ours", means, seconds, tuple(added.effect for added in report.added))


def told(paths: list[Path], folder: Path) -> None:
    """The logs with the arm's mass and the supply."""
    folder.mkdir()
    for path in paths:
        content = json.loads(path.read_text())
        content |= {"arm_mass": ARM[content["mass"]], "vin": SUPPLY}
        content.pop("motor_params", None)
        (folder / path.name).write_text(json.dumps(content))


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--bam", type=Path, required=True)
    parser.add_argument("--bam-python", default=sys.executable)
    parser.add_argument("--models", nargs="+", default=["m1", "m2", "m3", "m4", "m5", "m6"])
    parser.add_argument("--seconds", type=float, default=110.0)
    parser.add_argument("--gain", type=int, default=8)
    asked = parser.parse_args()
    paths = sorted((asked.data / "sts3215").glob("*.json"))
    if not paths:
        sys.exit(f"{asked.data}/sts3215 holds no logs: `frictionjoint data list` names them")
    print(f"| held out | model | {' | '.join(MOTIONS)} | mean | s |")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        told(paths, folder / "raw")
        bam = Bam(asked.bam, asked.bam_python, folder / "raw", folder, "sts3215", asked.seconds)
        for model in asked.models:
            print(bam.row(asked.gain, model, MANY), flush=True)
    print(ours(paths, asked.gain), flush=True)


if __name__ == "__main__":
    main()
