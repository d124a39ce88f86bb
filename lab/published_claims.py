"""Published figures on public logs, with ours next to them: one run, one table.

    python lab/published_claims.py --data DIR --out DIR [--only emps --only xl330] [--write]
        [--pulses DATA_EMPS_PULSES.mat] [--bam PYTHON] [--figaroh PYTHON] [--trainnr PYTHON]

--data is the folder of `real_logs.py`, with the UR10e's log of `motor_logs.py` in it. The second
EMPS log is given on its own. BAM, figaroh and trainnr run in environments of their own,
given by their Python. Each claim is fitted and judged as its authors did, on the same samples.
Seconds are those of the processor. Lines are those that a user writes: one command is one line; for
programs without a command, the script here that calls them. What was run stays in --out as JSON;
--write writes lab/notes/published_claims.md from it.
"""

import argparse
import ast
import json
import os
import tempfile
import time
from datetime import date
from pathlib import Path

import numpy as np

from frictionjoint import close_loop, evaluate, read_log

ROOT = Path(__file__).resolve().parents[1]
NOTES = ROOT / "lab/notes/published_claims.md"
HEAD = """# Published claims, reproduced

Written on {day} by `python lab/published_claims.py --data DIR --out DIR --write`. Each claim
is fitted and judged as its authors did. Published: figures in the source; here: run for this table.
Seconds of one processor from logs to model; BAM searches as long as ours took. Lines: what a user
writes; a command is one, for a program without a command the script in lab/ that calls it.

| Logs | Figure | Program | Published | Here | s | Lines |
|---|---|---|---|---|---|---|
"""
# of EMPS_Description.pdf: 1 - 50 are left out at the border of their differences
BORDER = 50
EMPS = "EMPS (Janot, Gautier, Brunot 2019)"
# mass, viscous, Coulomb, offset; their errors, per cent
THEIRS = (95.1089, 203.5034, 20.3935, -3.1648)
LOOP = {"position": "0.01375%", "velocity": "0.2291%"}


def row(logs, figure, program, published="", here="", seconds="", lines=""):
    """A row of the table."""
    return [logs, figure, program, published, here, seconds, lines]


def emps(asked):
    """Fitted to the whole first log, simulated in closed loop; the pulses predicted."""
    first = asked.data / "emps/DATA_EMPS.mat"
    log = read_log(first)
    model, spent = asked.out / "emps.xml", asked.out / "emps.seconds"
    if not model.exists():
        begin = time.process_time()
        report = close_loop([log], ROOT / "models/emps.xml", "carriage", 0.25)
        spent.write_text(f"{time.process_time() - begin:.0f}")
        model.write_text(report.mjcf)
    controller = ROOT / "models/emps.controller.toml"
    judged = evaluate(model, [first], controller=controller).joints["carriage"].curves[0]
    figure, script = "force error of the fit", "their least squares"
    found = [
        row(EMPS, figure, script, "4.083%", f"{_their_error(log):.2f}%", "", "94"),
        row(EMPS, figure, f"{script}, per direction", "3.112%", "", "", "105"),
        row(EMPS, figure, "frictionjoint", "", f"{_error(judged):.2f}%", spent.read_text(), "1"),
    ]
    for what, error in _loop_errors(judged).items():
        figure = f"closed loop, {what}"
        found.append(row(EMPS, figure, "their simulation", LOOP[what]))
        found.append(row(EMPS, figure, "frictionjoint", "", f"{error:.4g}%", "", "1"))
    if asked.pulses:
        figure = "force error, log with pulses, not fitted"
        theirs = _their_error(read_log(asked.pulses), THEIRS)
        ours = _error(evaluate(model, [asked.pulses]).joints["carriage"].curves[0])
        found.append(row(EMPS, figure, "their numbers", "", f"{theirs:.2f}%"))
        found.append(row(EMPS, figure, "frictionjoint", "", f"{ours:.2f}%", "", "1"))
    return found


def _error(curves):
    """Relative error of the torque that a model needs, filtered as theirs, per cent."""
    needed, drive = (_decimated(x)[10:-10] for x in (curves.needed, curves.drive))
    return 100.0 * np.linalg.norm(needed - drive) / np.linalg.norm(drive)


def _loop_errors(curves):
    """As they state it: norm of the error over the norm of the signal, per cent."""
    errors = {}
    measured, simulated = curves.position, curves.closed_loop
    for name in ("position", "velocity"):
        left, size = (np.linalg.norm(x[BORDER:]) for x in (measured - simulated, measured))
        errors[name] = 100.0 * left / size
        step = float(np.median(np.diff(curves.time)))
        measured, simulated = (_low(np.gradient(x, step), step) for x in (measured, simulated))
    return errors


def _low(x, step):
    """Their filter of measured and simulated signals: 4th order, 100 Hz, zero phase."""
    from scipy.signal import butter, filtfilt

    return filtfilt(*butter(4, 200.0 * step), x)


def _their_error(log, numbers=None):
    """Relative error of their four numbers, filtered as theirs, per cent; None: fitted here."""
    step = float(np.median(np.diff(log.time)))
    q = _low(log.position, step)
    v = np.gradient(q, step)
    parts = np.stack([np.gradient(v, step), v, np.sign(v), np.ones_like(v)], 1)
    # their parallel decimation: every 10th sample after a filter of 0.8 of that Nyquist frequency
    rows = np.stack([_decimated(x) for x in parts.T], 1)[10:-10]
    force = _decimated(log.torque)[10:-10]
    if numbers is None:
        numbers = np.linalg.lstsq(rows, force, rcond=None)[0]
    left = force - rows @ np.asarray(numbers)
    return 100.0 * np.linalg.norm(left) / np.linalg.norm(force)


def _decimated(x):
    from scipy.signal import decimate

    return decimate(x, 10, ftype="iir", zero_phase=True)


def xl330(asked):
    """Gain 400 held out, whole logs from the target."""
    return servo("XL330 (BAM)", "xl330", asked, 400)


def sts3215(asked):
    """Gain 8 held out; the authors' own fits with BAM are on trimmed logs of all gains."""
    name = "STS3215 (K-Scale)"
    authors = "BAM M1 to M6, the logs' authors"
    figure = "mean position error, all gains fitted"
    return [
        row(name, f"{figure}, trimmed logs", authors, "0.0309 to 0.0323 rad"),
        row(name, f"{figure}, all of each log", authors, "0.0415 rad"),
        *servo(name, "sts3215", asked, 8),
    ]


def servo(name, kind, asked, gain):
    """Our row of a servo, and BAM's with the same time on the same split, if it is installed."""
    from compare_with_bam import Bam, ours, paths_of

    paths = paths_of(asked.data, kind)
    best = ours(kind, paths, gain)
    figure = f"closed loop, gain {gain} held out, mean position error"
    s = f"{best.seconds:.0f}"
    found = [row(name, figure, "frictionjoint", "", f"{best.mean:.4f} rad", s, "1")]
    if asked.bam:
        with tempfile.TemporaryDirectory() as folder:
            # an installed BAM needs no checkout on the path
            theirs = Bam(Path(folder), asked.bam, paths, Path(folder), kind, best.seconds)
            for model in ("m1", "m3", "m6"):
                error = f"{theirs.row(gain, model).mean:.4f} rad"
                found.append(row(name, figure, f"BAM 1.0.2, {model.upper()}", "", error, s, "3"))
    return found


# script that calls each program; one command calls ours
SCRIPTS = {
    "mujoco.sysid": "sysid_robot.py",
    "figaroh 1.0.2": "figaroh_robot.py",
    "trainnr 0.1": "trainnr_robot.py",
}


def lines_for(program):
    """Lines of code with which a program is called here: without empty ones and docstrings."""
    if program not in SCRIPTS:
        return "1"
    tree = ast.parse(Path(__file__).with_name(SCRIPTS[program]).read_text())
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(
            node
        ):
            del node.body[0]
    return str(sum(bool(line.strip()) for line in ast.unparse(tree).splitlines()))


def robot(title, name):
    """A claim on a whole robot: the last 30% held out, all programs on the same samples."""

    def claim(asked):
        import real_robots
        import robot_rivals

        asked.reports = asked.out / "robots"
        asked.reports.mkdir(exist_ok=True)
        if not (asked.reports / name / "report.json").exists():
            real_robots.run(real_robots.ROBOTS[name], asked.data, asked.reports / name)
        case = robot_rivals.case_of(real_robots.ROBOTS[name], asked.data)
        found, joints = [], len(robot_rivals.moved(case))
        for program in robot_rivals.installed(asked):
            torque, replay, s = robot_rivals.by_program(program, name, case, asked)
            figure = f"torque error held out, mean of {joints} joints; free runs of 2 s"
            runs = f"{replay:.2g} rad" if replay < 10.0 else "diverge"
            cells = (
                f"{torque:.1f}%; {runs}",
                f"{s:.0f}" if s > 1.0 else f"{s:.1f}",
                lines_for(program),
            )
            found.append(row(title, figure, program, "", *cells))
        return found

    return claim


CLAIMS = {
    "emps": emps,
    "xl330": xl330,
    "sts3215": sts3215,
    "ur10": robot("UR10 (Petrone et al.)", "ur10"),
    "tx40": robot("TX40 (figaroh-examples)", "tx40"),
    "panda": robot("Panda (Gaz et al. 2019)", "panda"),
    "ur10e": robot("UR10e (Mamedov, Mikhel 2020)", "ur10e"),
}


def main():
    """Run what was not run yet, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=list(CLAIMS), default=[])
    parser.add_argument("--pulses", type=Path)
    for program in ("bam", "figaroh", "trainnr"):
        parser.add_argument(f"--{program}", help=f"Python of an environment that has {program}")
    parser.add_argument("--limit", type=float, default=120.0, help="s of sysid's, of one processor")
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, claim in CLAIMS.items():
        kept = asked.out / f"{name}.json"
        if not kept.exists() and (not asked.only or name in asked.only):
            part = kept.with_suffix(".part")
            part.write_text(json.dumps(claim(asked), indent=1))
            os.replace(part, kept)
        if kept.exists():
            rows += json.loads(kept.read_text())
    text = HEAD.format(day=date.today()) + "".join(f"| {' | '.join(cells)} |\n" for cells in rows)
    print(text)
    if asked.write:
        below = NOTES.read_text().partition("\n\n## ")[1:] if NOTES.exists() else ()
        NOTES.write_text(text + "".join(below))


if __name__ == "__main__":
    main()
