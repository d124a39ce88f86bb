"""Is the smallest effect that a report states true?

    python lab/smallest_effect.py FOLDER... --each 2 --times 1.5 --seed 1 --jobs 2 --out FILE

FOLDER holds logs that hide nothing, as `trials.py` reads them. Their search states for every effect
the smallest torque that they would have shown. Effects drawn at random, of a random shape of their
grid, are then added to the same logs, so many times as large as stated for that shape, and the
search runs again. An effect is found if it is named, or tied with what is named.
"""

import argparse
import json
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))  # tests.planting
from trials import joint_of, on_one_thread

from frictionjoint.diagnose.detection_limit import smallest
from frictionjoint.diagnose.library import effects
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.readers import read_log
from tests.planting import planted


def one_folder(folder: Path, each: int, times: float, seed: int) -> list[dict[str, Any]]:
    """A row for each effect planted in the logs of a folder."""
    warnings.simplefilter("ignore")
    joint = joint_of(folder / "model.xml")
    body = RigidBody(folder / "model.xml", joint)
    logs = [read_log(path, joint) for path in sorted(folder.glob("fit*.csv"))]
    found = trace(prepare(logs, body))
    rows: list[dict[str, Any]] = []
    if found.findings:
        return [{"folder": str(folder), "added": [f.term.name for f in found.findings]}]
    rng = np.random.default_rng([seed, *folder.name.encode()])
    blocks = make_blocks(found.prepared, found.final)
    known = [c for c in effects(found.prepared, found.final, blocks) if c.term.coefficients]
    names = sorted({c.term.name for c in known})
    for name in rng.choice(names, min(each, len(names)), replace=False):
        shapes = [c for c in known if c.term.name == name]
        candidate = shapes[rng.integers(len(shapes))]
        (stated,) = smallest(found.final, blocks, [candidate], found.detection_limit.torque)
        with_it = planted(found, logs, candidate, times * stated, rng)
        after = trace(prepare(with_it, body))
        added = [[f.term.name, *f.ties] for f in after.findings]
        rows.append(
            {
                "folder": str(folder),
                "effect": str(name),
                "shape": candidate.term.shape,
                "stated": stated,
                "over_friction": stated / float(np.sqrt(np.mean(found.final.friction**2))),
                "found": any(name in names for names in added),
                "added": added,
                "unexplained": dict(after.unexplained),
            }
        )
        print(json.dumps(rows[-1]), flush=True)
    return rows


def main() -> None:
    """Plant effects in the logs of all folders, print how many are found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("folders", type=Path, nargs="+", metavar="FOLDER")
    parser.add_argument("--each", type=int, default=2)
    parser.add_argument("--times", type=float, default=1.5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="file of rows, written anew")
    asked = parser.parse_args()
    rows = []
    with ProcessPoolExecutor(asked.jobs, initializer=on_one_thread) as pool:
        work = [
            pool.submit(one_folder, f.resolve(), asked.each, asked.times, asked.seed)
            for f in asked.folders
        ]
        for done in work:
            rows += done.result()
    asked.out.write_text("".join(json.dumps(row) + "\n" for row in rows))
    tried = [row for row in rows if "found" in row]
    print(f"{sum(row['found'] for row in tried)} of {len(tried)} found")


if __name__ == "__main__":
    main()
