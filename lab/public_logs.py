"""Public logs that nothing was tried on before: the first command of each, and a least squares.

    python lab/public_logs.py --raw DIR --out DIR [--only cart --only sawyer]

`public_logs.toml` names the source of each log, its files in --raw, and the options. Each row is
one command `frictionjoint close-loop`, as a user would type it from --help and the log's own
documentation. A refusal is a row of its own. `least_squares.py` fits the same samples without this
package.
"""

import argparse
import json
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import mujoco
import numpy as np
from least_squares import held_out_error

from frictionjoint.errors import FrictionJointError
from frictionjoint.measured.log import split_in_time
from frictionjoint.measured.readers import read_log
from frictionjoint.measured.several_files import read_joined
from frictionjoint.measured.table import ReadOptions

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 1200.0
BODY = (
    '<mujoco><worldbody><body><joint name="joint" type="{kind}" axis="0 1 0"/>{mass}'
    "</body></worldbody></mujoco>"
)


def model_file(case, folder):
    """The MJCF of a case."""
    kind, *numbers = case["model"].split()
    if kind.endswith(".xml"):
        spec = mujoco.MjSpec.from_file(str(ROOT / "models" / kind))
        for name, zero in case.get("zero", {}).items():
            spec.joint(name).ref = zero
        path = folder / "model.xml"
        path.write_text(spec.to_xml())
        return path
    inertial = '<inertial pos="0 0 {com}" mass="{mass}" diaginertia="{turn} {turn} {turn}"/>'
    values = {
        "wheel": lambda inertia: {"com": 0, "mass": 1e-3, "turn": inertia},
        "pendulum": lambda mass, com: {"com": -float(com), "mass": mass, "turn": 1e-6},
        "slide": lambda mass: {"com": 0, "mass": mass, "turn": 1},
    }[kind](*numbers)
    path = folder / "model.xml"
    path.write_text(
        BODY.format(kind="slide" if kind == "slide" else "hinge", mass=inertial.format(**values))
    )
    return path


def command(case, raw, out):
    """The command line of a case."""
    folder = raw / case["folder"]
    joint = case.get("joint", "joint")
    logs = [str(folder / x) for x in case.get("logs", [])] or [str(folder)]
    held = case["held_out"]
    words = [*logs, "--held-out", held if held[0] == "0" and held[1] == "." else str(folder / held)]
    words += ["--join"] if case.get("join") else []
    words += [x for k, v in case["columns"].items() for x in ("--column", f"{k}={v}")]
    words += [x for k, v in case.get("units", {}).items() for x in ("--unit", f"{k}={v}")]
    if "controller" in case:
        (out / "controller.toml").write_text(case["controller"])
        words += ["--controller", str(out / "controller.toml")]
    return [*words, "--model", str(model_file(case, out)), "--joint", joint, "--out", str(out)]


def row(name, case, raw, out):
    """What the command says, as a row."""
    out, attempts = out / name, case.get("attempts", 1)
    out.mkdir(parents=True, exist_ok=True)
    begin = time.perf_counter()
    if not (out / "report.json").exists():
        words = command(case, raw, out)
        (out / "command.txt").write_text(" ".join(words))
        run = [sys.executable, "-c", "from frictionjoint.cli import main; main()", "close-loop"]
        try:
            done = subprocess.run(
                [*run, *words, "--force"], capture_output=True, text=True, timeout=LIMIT
            )
        except subprocess.TimeoutExpired:
            return f"| {name} | {attempts} | not ended after {LIMIT:.0f} s | | | | | |"
        if done.returncode:
            said = done.stderr.strip().splitlines()[-1].removeprefix("frictionjoint: ")
            (out / "refused.txt").write_text(said)
            plain = least_squares(case, raw)
            return f"| {name} | {attempts} | refused: {said[:300]} | | | | {plain} | |"
        (out / "seconds.txt").write_text(f"{time.perf_counter() - begin:.0f}")
    found = json.loads((out / "report.json").read_text())
    seconds = (out / "seconds.txt").read_text() if (out / "seconds.txt").exists() else ""
    return " | ".join(
        [f"| {name} | {attempts}", *figures(found), least_squares(case, raw), f"{seconds} |"]
    )


def figures(found):
    """Verdict, names, and errors held out."""
    return [
        found["verdict"],
        ", ".join(x["effect"] for x in found["added"]) or "nothing",
        *(_part(found, stage) for stage in ("before", "after")),
    ]


def _part(found, stage):
    """Torque error held out over the rms of the drive there."""
    error, size = found[stage]["torque_rms"]["held_out"], found["drive"]["rms"][stage]["held_out"]
    return f"{100.0 * error / size:.1f}%" if error is not None and size else ""


def least_squares(case, raw):
    """Relative held-out error of the least squares, as a cell."""
    try:
        folder, joint = raw / case["folder"], case.get("joint", "joint")
        how = ReadOptions(case["columns"], units=case.get("units") or {})
        if case.get("join"):
            logs = [read_joined(sorted(folder.iterdir()), joint, how)]
        else:
            logs = [read_log(folder / x, joint, **vars(how)) for x in case["logs"]]
        held = case["held_out"]
        if held.startswith("0."):
            parts = [split_in_time(log, float(held)) for log in logs]
            logs, kept = [a for a, _ in parts], [b for _, b in parts]
        else:
            kept = [read_log(folder / held, joint, **vars(how))]
        gravity = not case["model"].startswith(("wheel", "slide"))
        error, _ = held_out_error(_arrays(logs), _arrays(kept), gravity)
    except (FrictionJointError, ValueError, OSError):
        return ""
    return "" if np.isnan(error) else f"{100.0 * error:.1f}%"


def _arrays(logs):
    found = []
    for log in logs:
        drives = (log.torque, log.voltage, log.current)
        drive = next((x for x in drives if x is not None), None)
        if drive is None:
            raise ValueError("no drive")
        found.append((log.time, log.position, drive))
    return found


def main():
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--raw", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", default=[])
    asked = parser.parse_args()
    cases = tomllib.loads((ROOT / "lab/public_logs.toml").read_text())
    print("| log | attempts | verdict | named | held out before | after | least squares | s |")
    for name, case in cases.items():
        if not asked.only or name in asked.only:
            print(row(name, case, asked.raw, asked.out), flush=True)


if __name__ == "__main__":
    main()
