"""Trials of the search: folders of test joints, judged family by family.

    python lab/trials.py FOLDER... --jobs 2 --out results.jsonl
    python lab/trials.py --out results.jsonl                  the tables alone

A FOLDER is a plant, or holds plants: fit*.csv, held.csv, model.xml (what the user believes about
the joint) and answer.json (what it is in truth; read for the judgement, never by the search). See
`judging.py` for the families, `make_plants.py` for test joints of `lab/plants`.

Each plant runs in one thread as `close-loop` would search its logs, and is a row of the file as
soon as it is done; a plant that has a row is not run again. The error of the held-out log counts
where its position determines the torque. It is compared with what a true model leaves: the noise
that answer.json states, behind the same filter.
"""

import argparse
import json
import sys
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from judging import read_answer, tables, told

from frictionjoint.diagnose.report_parts import noise_floor
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import predict
from frictionjoint.identify.weights import errors_of, weighted
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.free_runs import replayed_whole
from frictionjoint.threads import allow


def one_plant(folder: Path) -> dict[str, Any]:
    """A row of the file: what the search said of a test joint, and how well that predicts."""
    warnings.simplefilter("ignore")
    row: dict[str, Any] = {"plant": str(folder)}
    try:
        return row | searched(folder)
    except Exception as error:  # a bug must not end hundreds of trials: it is counted and shown
        return row | {"error": f"{type(error).__name__}: {error}"}


def searched(folder: Path) -> dict[str, Any]:
    """What the search finds in the logs of a test joint."""
    joint = joint_of(folder / "model.xml")
    body = RigidBody(folder / "model.xml", joint)
    begin, cpu = time.perf_counter(), time.process_time()
    logs = [read_log(path, joint) for path in sorted(folder.glob("fit*.csv"))]
    fitted_on = prepare(logs, body)
    found = trace(
        fitted_on, replayed=lambda prepared, fitted: replayed_whole(prepared, body, fitted)
    )
    seconds, cpu = time.perf_counter() - begin, time.process_time() - cpu
    kept = prepare([read_log(folder / "held.csv", joint)], body, fitted_on.band)
    held = held_out_error(kept, found.prepared, found.final)
    s, gain = kept.segments[0], found.final.gain
    true = read_answer(folder).left(s.bandwidth_hz, s.sample)
    return {
        "added": [f.term.name for f in found.findings],
        "ties": [list(f.ties) for f in found.findings],
        "gains": [f.gain for f in found.findings],
        "unexplained": dict(found.unexplained),
        "law": law_parameters(found.final).law,
        "held_rms": held,
        "over_true": held / (true * gain) if true else None,
        "over_floor": held / noise_floor(kept, gain),
        "seconds": seconds,
        "cpu_s": cpu,
    }


def held_out_error(kept: Prepared, fitted_on: Prepared, final: Fit) -> float:
    """rms error of the torque in motion, N m.

    Args:
        kept: the logs held out. fitted_on: those of the fit, as they were weighted last.
    """
    told_by = predict(weighted(kept, final, errors_of(fitted_on, final)), final)
    return float(np.sqrt(np.mean(told_by.error[told_by.in_motion] ** 2)))


def joint_of(model: Path) -> str:
    """The joint under trial: `joint`, or the only one of the model."""
    names = [j.get("name", "") for j in ElementTree.parse(model).getroot().iter("joint")]
    return "joint" if "joint" in names else names[0]


def plants_in(folders: list[Path]) -> Iterator[Path]:
    """The test joints of some folders, in order."""
    for folder in folders:
        inside = [path.parent for path in sorted(folder.glob("*/answer.json"))]
        if (folder / "answer.json").exists():
            inside.append(folder)
        if not inside:
            sys.exit(f"{folder}: no plants, give a folder with NUMBER/answer.json")
        yield from (plant.resolve() for plant in inside)


def on_one_thread() -> None:
    """Trials side by side fill the cores: threads within them would wait for each other."""
    allow(1)


def main() -> None:
    """Run the trials that have no row yet, print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("folders", type=Path, nargs="*", metavar="FOLDER")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="file of rows, added to")
    asked = parser.parse_args()
    text = asked.out.read_text() if asked.out.exists() else ""
    rows = {row["plant"]: row for row in map(json.loads, text.splitlines())}
    plants = list(plants_in(asked.folders)) or [Path(plant) for plant in rows]
    with ProcessPoolExecutor(asked.jobs, initializer=on_one_thread) as pool:
        new = [plant for plant in plants if str(plant) not in rows]
        todo = [pool.submit(one_plant, plant) for plant in new]
        for done in as_completed(todo):
            row = done.result()
            rows[row["plant"]] = row
            with asked.out.open("a") as file:
                file.write(json.dumps(row) + "\n")
            line = told(read_answer(Path(row["plant"])), row)
            print(f"{row['plant']}  {line}  {row.get('seconds', 0.0):.1f} s", flush=True)
    print(tables((read_answer(plant), rows[str(plant)]) for plant in plants))


if __name__ == "__main__":
    main()
