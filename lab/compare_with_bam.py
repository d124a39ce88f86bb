"""BAM (Rhoban) next to this package on servo logs: the same split and about the same time.

    python lab/compare_with_bam.py sts3215 --data DIR --bam CHECKOUT --bam-python PYTHON
        [--models m1 m2 m3 m4 m5 m6] [--seconds 110] [--gain 8]
    python lab/compare_with_bam.py xl330 --data DIR --bam CHECKOUT --bam-python PYTHON --gain 400

--data holds the logs in ``sts3215/`` and ``xl330/``. --bam is a checkout of github.com/Rhoban/bam
and --bam-python a Python that has what its ``identification`` extra asks for (numpy, optuna, cmaes,
wandb, matplotlib, colorama). One firmware gain is held out, the others are fitted, nothing is
trimmed. Ours is the row of `servo_logs.py`, refined; BAM's is its own ``bam.process``, ``bam.fit``
and ``bam.mae``, and each of its models searches for --seconds of its process and keeps the best
that it found. Of the STS3215 it is told the arm's mass and the supply that the servo reads (12 V),
which the logs' own figures leave out or have wrong (15 V); it fits kt, R, armature, the gain of the
error, an offset and the largest speed of the target next to friction.
Errors: mean of |simulated - measured position| of whole logs given the target alone, rad, on BAM's
grid of 5 ms, by motion and over all.
"""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from servo_logs import JOINT, Split

from frictionjoint.measured.readers import read_log

GRID = 0.005
# kg, by the tip's mass: as models/README.md has it
ARM, SUPPLY = {0.535: 0.036, 0.969: 0.050}, 12.0


@dataclass(frozen=True)
class Row:
    """A model on one held-out gain.

    Attributes:
        gain: held out. model: whose. errors: rad, by motion. seconds: from logs to model.
        effects: that our loop added.
    """

    gain: int
    model: str
    errors: dict[str, float]
    seconds: float
    effects: tuple[str, ...] = ()

    @property
    def mean(self) -> float:
        """Over the motions, rad."""
        return float(np.mean(list(self.errors.values())))

    def __str__(self) -> str:
        errors = " | ".join(f"{self.errors[name]:.4f}" for name in sorted(self.errors))
        return f"| {self.gain} | {self.model} | {errors} | {self.mean:.4f} | {self.seconds:.0f} |"


def paths_of(data: Path, servo: str) -> list[Path]:
    """The logs of a servo."""
    paths = sorted((data / servo).glob("*.json"))
    if not paths:
        sys.exit(f"{data / servo} holds no logs: `frictionjoint data list` names them")
    return paths


def motion_of(path: Path) -> str:
    """Name of the motion a log is of."""
    return str(json.loads(path.read_text())["trajectory"])


def ours(servo: str, paths: list[Path], gain: int) -> Row:
    """The loop, refined, on the other gains."""
    logs = {path: read_log(path, JOINT) for path in paths}
    held = {path: log for path, log in logs.items() if log.metadata["kp"] == gain}
    fitted = [log for path, log in logs.items() if path not in held]
    begin = time.process_time()
    report = Split(servo, f"kp {gain}", fitted, list(held.values())).report()
    seconds = time.process_time() - begin
    assert report.refined
    assert report.closed_loops
    best = report.refined.loops if report.refined.taken else report.closed_loops[-1]
    errors: dict[str, list[float]] = {}
    assert best.held_out
    for path, log, simulated in zip(held, held.values(), best.held_out.simulated, strict=True):
        grid = np.arange(0.0, log.duration, GRID) + log.time[0]
        there, here = (np.interp(grid, log.time, x) for x in (simulated, log.position))
        errors.setdefault(motion_of(path), []).append(float(np.mean(np.abs(there - here))))
    effects = tuple(added.effect for added in report.added)
    return Row(gain, "ours", _means(errors), seconds, effects)


def _means(errors: dict[str, list[float]]) -> dict[str, float]:
    return {name: float(np.mean(x)) for name, x in errors.items()}


class Bam:
    """BAM's own programs, run as its documentation says, on logs resampled by itself.

    Args:
        paths: raw logs. folder: to work in. servo: its name there too.
        seconds: of its process, after which a search ends with the best it has.
    """

    def __init__(
        self,
        checkout: Path,
        python: str,
        paths: list[Path],
        folder: Path,
        servo: str,
        seconds: float,
    ) -> None:
        self.checkout, self.python, self.folder = checkout.resolve(), python, folder
        self.servo, self.seconds = servo, seconds
        self.processed, raw = folder / "processed", folder / "raw"
        for made in (self.processed, raw):
            made.mkdir()
        for path in paths:
            content = json.loads(path.read_text())
            if servo == "sts3215":
                content |= {"arm_mass": ARM[content["mass"]], "vin": SUPPLY}
                content.pop("motor_params", None)
            (raw / path.name).write_text(json.dumps(content))
        self._run("bam.process", "--raw", raw, "--logdir", self.processed)

    def row(self, gain: int, model: str) -> Row:
        """Fit one of its models on the other gains, replay this one."""
        # its judge takes a folder of parameters since BAM 1.0
        fits, table = self.folder / f"{model}_{gain}", self.folder / "mae.json"
        fits.mkdir()
        parameters = fits / f"{model}.json"
        begin = time.perf_counter()
        self._run("bam.fit", "--actuator", self.servo, "--model", model,
                  "--logdir", self.processed, "--validation_kp", gain, "--trials", 10**6,
                  "--output", parameters, seconds=self.seconds)  # fmt: skip
        seconds = time.perf_counter() - begin
        held = self.folder / f"held_{gain}"
        held.mkdir(exist_ok=True)
        for path in self.processed.glob("*.json"):
            if json.loads(path.read_text())["kp"] == gain and not (held / path.name).exists():
                (held / path.name).symlink_to(path)
        self._run("bam.mae", "--params", fits, "--logdir", held, "--json", table)
        per_log = json.loads(table.read_text())[parameters.stem]["per_log"]
        # in the order in which `bam.logs` lists the folder
        listed = [held / name for name in os.listdir(held) if name.endswith(".json")]
        errors: dict[str, list[float]] = {}
        for path, error in zip(listed, per_log, strict=True):
            errors.setdefault(motion_of(path), []).append(error)
        return Row(gain, f"BAM {model.upper()}", _means(errors), seconds)

    def _run(self, module: str, *arguments: object, seconds: float | None = None) -> None:
        # its parameters are written whenever they are better: a search may end at any time
        limit = None if seconds is None else partial(_end_after, seconds)
        done = subprocess.run(
            [self.python, "-m", module, *map(str, arguments)],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self.checkout), "MPLBACKEND": "agg"},
            capture_output=True,
            text=True,
            preexec_fn=limit,
        )
        if limit and done.returncode == -signal.SIGXCPU:
            return
        if done.returncode:
            sys.exit(f"{module} of the checkout failed: {done.stderr.strip().splitlines()[-1]}")


def _end_after(seconds: float) -> None:
    """End this process after some seconds of its own."""
    resource.setrlimit(resource.RLIMIT_CPU, (round(seconds), round(seconds) + 5))


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("servo", choices=("sts3215", "xl330"))
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--bam", type=Path, required=True)
    parser.add_argument("--bam-python", default=sys.executable)
    parser.add_argument("--models", nargs="+", default=["m1", "m2", "m3", "m4", "m5", "m6"])
    parser.add_argument("--seconds", type=float, default=110.0)
    parser.add_argument("--gain", type=int, default=8)
    asked = parser.parse_args()
    paths = paths_of(asked.data, asked.servo)
    motions = sorted(set(map(motion_of, paths)))
    print(f"| held out | model | {' | '.join(motions)} | mean | s |")
    with tempfile.TemporaryDirectory() as name:
        bam = Bam(asked.bam, asked.bam_python, paths, Path(name), asked.servo, asked.seconds)
        for model in asked.models:
            print(bam.row(asked.gain, model), flush=True)
    print(ours(asked.servo, paths, asked.gain), flush=True)


if __name__ == "__main__":
    main()
