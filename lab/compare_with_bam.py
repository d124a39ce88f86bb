"""BAM (Rhoban) next to this package on the XL330 logs, by the error that BAM is judged by.

    python lab/compare_with_bam.py --data DIR [--bam CHECKOUT --bam-python PYTHON]
        [--models m1 m3 m6] [--trials 300] [--gains 400 200 100 800] [--write]

--data holds the logs in ``xl330/``. --bam is a checkout of github.com/Rhoban/bam and --bam-python a
Python that has what its ``identification`` extra asks for (numpy, optuna, cmaes, wandb,
matplotlib, colorama); without them only our figures are printed. --write writes
lab/notes/peer.md after every gain.

Each firmware gain is held out once, the others are fitted. Ours is `frictionjoint.close_loop`, its
model.xml run in MuJoCo; BAM's is its own ``bam.process``, ``bam.fit`` and ``bam.mae``. Both replay
whole logs of the held-out gain in closed loop: the servo's control law is simulated and given the
target only. The error is the mean of |simulated - measured position|, rad, on BAM's grid of 5 ms.
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
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
from servo_loop import Servo, run_servo

from frictionjoint import close_loop
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

ROOT = Path(__file__).resolve().parents[1]
JOINT = "pendulum"
MODEL = ROOT / "models/xl330_pendulum.xml"
PAGE, NOTES = ROOT / "lab/notes/peer.md", "## What was found"
# as BAM has the firmware: counts a turn, over its divisor of the gain and the count of full duty
DUTY_PER_RAD = 4096 / (2 * np.pi) / (256 * 885)
GRID = 0.005
TRAJECTORIES = ("sin_sin", "lift_and_drop", "up_and_down", "sin_time_square")
COLUMNS = f"| held out | model | {' | '.join(TRAJECTORIES)} | mean | s |"


@dataclass(frozen=True)
class Row:
    """A model on one held-out gain.

    Attributes:
        gain: held out. model: whose. errors: rad, by trajectory. seconds: from logs to model.
        effects: that our loop added. unexplained: what it names as left.
    """

    gain: int
    model: str
    errors: dict[str, float]
    seconds: float
    effects: tuple[str, ...] = ()
    unexplained: tuple[str, ...] = ()

    @property
    def mean(self) -> float:
        """Over the trajectories, rad."""
        return float(np.mean(list(self.errors.values())))

    def __str__(self) -> str:
        names = [*TRAJECTORIES, *(name for name in self.errors if name not in TRAJECTORIES)]
        errors = " | ".join(f"{self.errors[name]:.4f}" for name in names)
        return f"| {self.gain} | {self.model} | {errors} | {self.mean:.4f} | {self.seconds:.0f} |"


def ours(paths: list[Path], gain: int) -> Row:
    """Fit on the other gains, replay this one."""
    logs = {path: read_log(path, JOINT) for path in paths}
    held = {path: log for path, log in logs.items() if log.metadata["kp"] == gain}
    begin = time.perf_counter()
    fitted = [log for path, log in logs.items() if path not in held]
    report = close_loop(fitted, MODEL, JOINT, list(held.values()))
    seconds = time.perf_counter() - begin
    model = mujoco.MjModel.from_xml_string(report.mjcf)
    errors = {trajectory(path): error(model, log) for path, log in held.items()}
    effects = tuple(added.effect for added in report.added)
    return Row(gain, "ours", errors, seconds, effects, tuple(n for n, _ in report.unexplained))


def error(model: mujoco.MjModel, log: JointLog) -> float:
    """Mean |simulated - measured| of a log in closed loop, rad."""
    servo = Servo(log.metadata["kp"] * DUTY_PER_RAD, log.metadata["vin"])
    simulated = run_servo(model, JOINT, log, servo)
    grid = np.arange(0.0, log.duration, GRID)
    there, here = (np.interp(grid, log.time, x) for x in (simulated, log.position))
    return float(np.mean(np.abs(there - here)))


def trajectory(path: Path) -> str:
    """Name of the motion a log is of."""
    return str(json.loads(path.read_text())["trajectory"])


class Bam:
    """BAM's own programs, run as its documentation says, on logs resampled by itself.

    Args:
        logs: a folder of raw ones. folder: to work in. actuator: its name there.
        seconds: of its process, after which a search ends with the best it has; None: after its
            trials.
    """

    def __init__(
        self,
        checkout: Path,
        python: str,
        logs: Path,
        folder: Path,
        actuator: str = "xl330",
        seconds: float | None = None,
    ) -> None:
        self.checkout, self.python, self.folder = checkout.resolve(), python, folder
        self.actuator, self.seconds = actuator, seconds
        self.processed = folder / "processed"
        self.processed.mkdir()
        self._run("bam.process", "--raw", logs.resolve(), "--logdir", self.processed)

    def row(self, gain: int, model: str, trials: int) -> Row:
        """Fit one of its models on the other gains, replay this one."""
        # its judge takes a folder of parameters since BAM 1.0
        fits, table = self.folder / f"{model}_{gain}", self.folder / "mae.json"
        fits.mkdir()
        parameters = fits / f"{model}.json"
        begin = time.perf_counter()
        self._run("bam.fit", "--actuator", self.actuator, "--model", model,
                  "--logdir", self.processed, "--validation_kp", gain, "--trials", trials,
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
        errors: dict[str, list[float]] = {}
        for path, error in zip(map(Path, _listed(held)), per_log, strict=True):
            errors.setdefault(trajectory(path), []).append(error)
        means = {name: float(np.mean(x)) for name, x in errors.items()}
        return Row(gain, f"BAM {model.upper()}", means, seconds)

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


def _listed(folder: Path) -> list[str]:
    return [os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".json")]


def rows(asked: argparse.Namespace) -> Iterator[Row]:
    """Ours and theirs, gain by gain."""
    paths = sorted((asked.data / "xl330").glob("*.json"))
    if not paths:
        sys.exit(f"{asked.data}/xl330 holds no logs: `frictionjoint data list` names them")
    with tempfile.TemporaryDirectory() as folder:
        bam = None
        if asked.bam:
            bam = Bam(asked.bam, asked.bam_python, asked.data / "xl330", Path(folder))
        for gain in asked.gains:
            yield ours(paths, gain)
            if bam:
                yield from (bam.row(gain, model, asked.trials) for model in asked.models)


def page(found: list[Row], trials: int) -> str:
    """lab/notes/peer.md anew; its notes, written by hand, are kept."""
    lines = [
        "# Beside BAM",
        "",
        "Written by `python lab/compare_with_bam.py --data DIR --bam CHECKOUT --write`.",
        "[BAM](https://github.com/Rhoban/bam) (Duclusaud et al. 2024) fits a servo's friction by",
        "simulating whole logs thousands of times; the loop here fits torques and names what they",
        "lack. Both were fitted on three firmware gains of the sixteen XL330 logs and replay the",
        "fourth in closed loop, given the target alone. Mean absolute position error, rad; seconds",
        f"from logs to model, on one busy machine. BAM ran {trials} trials of its search a model",
        "(its default is 100,000): more may lower its errors.",
        "",
        COLUMNS,
        "|" + "---|" * (len(TRAJECTORIES) + 4),
        *map(str, found),
        "",
    ]
    lines += [
        f"* Gain {row.gain} held out: added {', '.join(row.effects) or 'nothing'}; unexplained: "
        f"{', '.join(row.unexplained) or 'nothing named'}."
        for row in found
        if row.model == "ours"
    ]
    return "\n".join([*lines, "", NOTES + PAGE.read_text().partition(NOTES)[2]])


def main() -> None:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--bam", type=Path, help="a checkout of github.com/Rhoban/bam")
    parser.add_argument("--bam-python", default=sys.executable)
    parser.add_argument("--models", nargs="+", default=["m1", "m3", "m6"])
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--gains", nargs="+", type=int, default=[400, 200, 100, 800])
    parser.add_argument("--write", action="store_true", help="write lab/notes/peer.md")
    asked = parser.parse_args()
    if asked.bam:
        print(f"BAM: {asked.trials} trials a model")
    print(COLUMNS)
    found: list[Row] = []
    for row in rows(asked):
        print(row, ", ".join(row.effects), flush=True)
        found.append(row)
        if asked.write:
            PAGE.write_text(page(found, asked.trials))


if __name__ == "__main__":
    main()
