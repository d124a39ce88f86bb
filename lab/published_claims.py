"""Published figures on public logs, with ours next to them: one run, one table.

    python lab/published_claims.py --data DIR --out DIR [--only emps --only xl330] [--write]
        [--pulses DATA_EMPS_PULSES.mat] [--bam CHECKOUT --bam-python PYTHON]

--data is the folder of `real_logs.py`. The second EMPS log and BAM's checkout are given on their
own. Each claim is fitted and judged as its authors did, on the same samples. Seconds are those of
the processor. Lines are those that a user writes: one command is one line. What was run stays in
--out as JSON; --write writes lab/notes/published_claims.md from it.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from frictionjoint import close_loop, evaluate, read_log

ROOT = Path(__file__).resolve().parents[1]
NOTES = ROOT / "lab/notes/published_claims.md"
HEAD = """# Published claims, reproduced

Written by `python lab/published_claims.py --data DIR --out DIR --write`. Each claim is fitted and
judged as its authors did. Published: figures in the source; here: run for this table. Seconds of
one processor from logs to model. Lines: what a user writes; a command is one.

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
    """Gain 400 held out, whole logs from the target; BAM with as much time."""
    import compare_with_bam as bam

    paths = sorted((asked.data / "xl330").glob("*.json"))
    begin = time.process_time()
    best = bam.ours(paths, 400)
    seconds = time.process_time() - begin
    name, figure = "XL330, 16 logs of BAM", "gain 400 held out, mean position error, rad"
    found = [row(name, figure, "frictionjoint", "", f"{best.mean:.4f}", f"{seconds:.0f}", "1")]
    if asked.bam:
        with tempfile.TemporaryDirectory() as folder:
            theirs = bam.Bam(
                asked.bam,
                asked.bam_python,
                asked.data / "xl330",
                Path(folder),
                seconds=asked.seconds,
            )
            for model in ("m1", "m3", "m6"):
                error = theirs.row(400, model, 10**6).mean
                found.append(
                    row(
                        name,
                        figure,
                        f"BAM {model.upper()}",
                        "",
                        f"{error:.4f}",
                        f"{asked.seconds:.0f}",
                        "3",
                    )
                )
    return found


def sts3215(asked):
    """Gain 8 held out; the authors' own fits with BAM are on trimmed logs of all gains."""
    import compare_with_bam_sts3215 as bam

    paths = sorted((asked.data / "sts3215").glob("*.json"))
    best = bam.ours(paths, 8)
    name, figure = "STS3215, 40 logs (K-Scale)", "mean position error, rad"
    return [
        row(
            name,
            figure,
            "BAM M1 to M6, of the logs' authors, trimmed logs, in-sample",
            "0.0323 to 0.0309",
        ),
        row(name, figure, "the same, all of each log", "0.0415"),
        row(
            name,
            f"gain 8 held out, {figure}",
            "frictionjoint",
            "",
            f"{best.mean:.4f}",
            f"{best.seconds:.0f}",
            "1",
        ),
    ]


def robot(name, log, model):
    """A claim on a whole robot: the last 30% held out."""

    def claim(asked):
        begin = time.process_time()
        report = close_loop([asked.data / log], ROOT / "models" / model, held_out=0.3)
        seconds = f"{time.process_time() - begin:.0f}"
        errors = [
            100.0 * x.after_torque.held_out / x.drive_rms("after").held_out
            for x in report.joints.values()
        ]
        figure = f"torque error held out, mean of {len(errors)} joints"
        here = f"{np.mean(errors):.1f}%"
        return [row(name, figure, "frictionjoint", "", here, seconds, "1")]

    return claim


CLAIMS = {
    "emps": emps,
    "xl330": xl330,
    "sts3215": sts3215,
    "ur10": robot("UR10 (Petrone et al.)", "unisa_ur10/ur10.csv", "ur10.xml"),
    "tx40": robot("TX40 (figaroh-examples)", "staubli_tx40", "staubli_tx40.xml"),
    "panda": robot("Panda (Gaz et al. 2019)", "panda", "panda.xml"),
}


def main():
    """Run what was not run yet, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=list(CLAIMS), default=[])
    parser.add_argument("--pulses", type=Path)
    parser.add_argument("--bam", type=Path)
    parser.add_argument("--bam-python", default=sys.executable)
    parser.add_argument("--seconds", type=float, default=60.0, help="of BAM's search per model")
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
    text = HEAD + "".join(f"| {' | '.join(cells)} |\n" for cells in rows)
    print(text)
    if asked.write:
        below = NOTES.read_text().partition("\n\n## ")[1:] if NOTES.exists() else ()
        NOTES.write_text(text + "".join(below))


if __name__ == "__main__":
    main()
