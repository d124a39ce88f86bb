"""Measured logs of whole robots: one command each, every joint before and after.

    python lab/real_robots.py --data DIR --out DIR [--only panda --only ur10] [--write]

Held out is the last 30% of each log. A folder of `--out` that has a report is not run again; with
`--write` the reports there are written to lab/notes/robots.md, before what else it holds. Memory
is the peak of all processes of a command together, as /proc has it.
"""

import argparse
import json
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.simulate.carrier import read_friction

ROOT = Path(__file__).resolve().parents[1]
HELD_OUT = "0.3"
PLACES = ("body", "joint", "other_joint", "common_to")
PAGE = "lab/notes/robots.md"
# what is not written here begins with it
REST = "## What a least squares leaves"
HEAD = """# Measured robots

Public logs of robots; `lab/motor_logs.py` makes those of the UR10e.
`python lab/real_robots.py --data DIR --out DIR --write` runs one
command for each, `frictionjoint close-loop LOG... --model ROBOT --held-out 0.3 --out OUT`, and
writes the tables. After them come [what is left, and why](#what-is-left-and-why), robots that were
[new](#robots-that-were-new) and [other programs](#beside-mujocosysid-and-figaroh).

* **Held out** is the last 30% of each log, which serves neither the fit nor the choice of effects.
* **Torque**: rms error in motion, in per cent of the rms of the joint's torque. Rest does not
  count: friction at rest is known only where the fitted logs hold presliding.
* **Replay**: rms position error, rad, of free runs of half a second on the same data.
* **Before** is the integrated law alone under the model as it is, **after** all that is named.
* **Shared causes** stand above each table, with standard errors; in brackets is the part of a
  joint's squares that a cause takes away in cross-validation.
* **The last column** says by how much an error is larger after than before, as a 95% interval
  (torque: paired, over blocks of time; replay: over runs). *Worse*: the
  interval is above zero and the sum of squares grows by more than 5%.

"""


@dataclass(frozen=True)
class Robot:
    """Logs of one robot and its model."""

    logs: tuple[str, ...]
    model: str


ROBOTS = {
    "panda": Robot(("panda",), "panda.xml"),
    "ur10": Robot(("unisa_ur10/ur10.csv",), "ur10.xml"),
    "tx40": Robot(("staubli_tx40",), "staubli_tx40.xml"),
    "kr300": Robot(("kuka_kr300/A.csv", "kuka_kr300/B.csv"), "kuka_kr300.xml"),
    "ur10e": Robot(("ur10e/20_02_12-40sec_12harm.csv",), "ur10e.xml"),
}


def run(robot: Robot, data: Path, out: Path) -> None:
    """The command, with its time and memory next to its report."""
    command = [sys.executable, "-c", "from frictionjoint.cli import main; main()", "close-loop"]
    command += [str(data / log) for log in robot.logs]
    command += ["--model", str(ROOT / "models" / robot.model)]
    command += ["--held-out", HELD_OUT, "--out", str(out)]
    begin, cpu, peak = time.perf_counter(), _cpu_s(), 0
    process = subprocess.Popen(command)
    while process.poll() is None:
        peak = max(peak, sum(_memory(pid) for pid in _family(process.pid)))
        time.sleep(0.25)
    if process.returncode:
        raise SystemExit(f"{out.name}: exit code {process.returncode}")
    seconds, cpu = time.perf_counter() - begin, _cpu_s() - cpu
    spent = {"seconds": seconds, "peak_gb": peak / 1e9, "cpu_s": cpu}
    (out / "spent.json").write_text(json.dumps(spent) + "\n")


def _cpu_s() -> float:
    """Of all commands that have ended."""
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _family(pid: int) -> list[int]:
    """A process and all that it started."""
    found = [pid]
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in _read(task).split():
            found += _family(int(child))
    return found


def _memory(pid: int) -> int:
    """Own pages of a process, bytes."""
    for line in _read(Path(f"/proc/{pid}/smaps_rollup")).splitlines():
        if line.startswith("Pss:"):
            return 1024 * int(line.split()[1])
    return 0


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:  # it has ended
        return ""


def moves_at_rest(path: Path) -> tuple[float, str]:
    """Largest movement of a joint within 30 s of rest, rad (m), and the joint's name.

    Without gravity, each joint is loaded by 0.4 of its slow sliding friction, over 5 s, and has
    25 s more to come to rest.
    """
    model = fj.load_model(path)
    model.opt.gravity[:] = 0.0
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data, slow, load = mujoco.MjData(model), np.linspace(0.0, 20.0, 20001), np.zeros(model.nv)
    names = read_friction(model)
    dofs = [int(model.joint(name).dofadr[0]) for name in names]
    for dof, friction in zip(dofs, names.values(), strict=True):
        torque = fj.friction_torque(friction.parameters, slow, 0.01 * slow)
        load[dof] = 0.4 * float(torque[-1])
    places, every = [], max(1, round(0.01 / model.opt.timestep))
    with fj.attach(model):
        while data.time < 60.0:
            data.qfrc_applied[:] = min(1.0, 0.2 * data.time) * load
            mujoco.mj_step(model, data, every)
            if data.time > 30.0:
                places.append(data.qpos[dofs].copy())
    moved = np.ptp(places, axis=0)
    return float(moved.max()), list(names)[int(moved.argmax())]


def _rest(folder: Path) -> str:
    moved, joint = moves_at_rest(folder / "model.xml")
    return f"Loaded at rest, {joint} moves by {moved:.0e} rad in 30 s, the others by less."


def section(name: str, folder: Path) -> str:
    """A robot's part of the page."""
    report = json.loads((folder / "report.json").read_text())
    spent = json.loads((folder / "spent.json").read_text())
    joints = report["joints"].values()
    # of each joint's whole torque, as in the rows: held out, a joint may be nearly at rest
    before, after = (
        100.0 * np.mean([r[key]["torque_rms"]["held_out"] / r["measured_rms"] for r in joints])
        for key in ("before", "after")
    )
    pair = [report[key]["replay_rms"]["held_out"] for key in ("before", "after")]
    lines = [
        f"## {name}",
        "",
        f"Torque error {before:.2f} to {after:.2f}% over the joints; all joints together "
        f"{_number(pair[0])} to {_number(pair[1])} rad in replay; {spent['seconds']:.0f} s "
        f"({spent['cpu_s']:.0f} s of processor time), {spent['peak_gb']:.1f} GB. {_rest(folder)}",
        "",
        *_shared(report),
        "| joint | effects added | torque before | after | replay before | after | |",
        "|---|---|---|---|---|---|---|",
        *(_row(joint, r) for joint, r in report["joints"].items()),
        *(f"| {joint} | {text} | | | | | |" for joint, text in report["failed"].items()),
    ]
    return "\n".join(lines) + "\n"


def _shared(report: dict[str, Any]) -> list[str]:
    found = []
    for cause in report["shared"]:
        place = " and ".join(cause[k] for k in PLACES if k in cause)
        values = ", ".join(
            f"{n} {x['value']:.3g}" + (f" ± {x['stderr']:.1g}" if x["stderr"] else "")
            for n, x in list(cause["parameters"].items())[:4]
        )
        gain = cause["evidence"]["held_out_gain"]
        found.append(f"* {cause['cause']}{' of ' + place if place else ''}: {values} ({gain:.0%})")
    return [*found, ""] if found else ["No shared cause.", ""]


def _row(joint: str, r: dict[str, Any]) -> str:
    size = r["measured_rms"]
    torque = [r[key]["torque_rms"]["held_out"] for key in ("before", "after")]
    place = [r[key]["replay_rms"]["held_out"] for key in ("before", "after")]
    effects = ", ".join(x["effect"] for x in r["added"]) or "none"
    cells = [f"{100 * x / size:.1f}%" for x in torque] + [_number(x) for x in place]
    said = ", ".join(
        _increase(name, x, size, name in r["worse"]) for name, x in r["increase"].items()
    )
    return f"| {joint} | {effects} | {' | '.join(cells)} | {said} |"


def _increase(name: str, interval: list[float | None], size: float, worse: bool) -> str:
    """Of an error that is larger after than before."""
    what = name.removesuffix("_rms")
    if None in interval:
        return f"{what}: too short to tell"
    low, high = (f"{100 * x / size:+.1f}%" if what == "torque" else f"{x:+.2g}" for x in interval)
    said = f"{what} {low} to {high}"
    return f"*worse: {said}*" if worse else said


def _number(x: float | None) -> str:
    return "-" if x is None else f"{x:.2g}"


def main() -> None:
    """Run what has no report yet, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=ROBOTS)
    parser.add_argument("--write", action="store_true", help=f"write {PAGE}")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    for name in asked.only or ROBOTS:
        if not (asked.out / name / "report.json").exists():
            run(ROBOTS[name], asked.data, asked.out / name)
        print(section(name, asked.out / name), flush=True)
    if asked.write:
        done = [n for n in ROBOTS if (asked.out / n / "report.json").exists()]
        page = ROOT / PAGE
        _, title, rest = page.read_text().partition(REST)
        sections = "\n".join(section(n, asked.out / n) for n in done)
        page.write_text(HEAD + sections + ("\n" + title + rest if title else ""))


if __name__ == "__main__":
    main()
