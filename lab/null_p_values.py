"""Whether a p-value is one: the search on joints that hide nothing, many times over.

    python lab/null_p_values.py --n 500 --seed 1 --jobs 2 --out null.jsonl

A LuGre joint in two short logs, fitted by that law: another law's error is no chance. The p-value
of the last look, over the whole family of candidates, should be uniform. Prints its histogram, the
test of Kolmogorov and Smirnov against uniformity, and how often anything was added.
"""

import argparse
import json
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from plants.plant import simulate, write
from plants.spec import Controller, Friction, Instrument, Motion, PlantSpec
from scipy.stats import kstest

from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.readers import read_log

_BINS = 10


def spec_of(rng: np.random.Generator) -> PlantSpec:
    """A joint of the seed's own size, motion and noise."""
    Fc = float(rng.uniform(0.3, 0.8))
    motions = tuple(
        Motion(kind, int(rng.integers(1 << 30)), float(rng.uniform(0.3, 0.6)), 1.0, 10.0)
        for kind in ("sines", "multisine")
    )
    return PlantSpec(
        mass=1.0,
        length=0.2,
        inertia=0.06,
        armature=0.02,
        friction=Friction("lugre", 1.2 * Fc, Fc, 0.1, sigma2=0.2 * Fc, presliding=2e-3),
        controller=Controller(kp=60.0, kd=3.0),
        motions=motions,
        instrument=Instrument(rate=200.0, counts=2**18, torque_noise=0.3 * Fc),
        seed=int(rng.integers(1 << 30)),
    )


def one(seed: int, number: int) -> dict[str, Any]:
    """A row of the file."""
    warnings.simplefilter("ignore")
    with TemporaryDirectory() as folder:
        paths = write(simulate(spec_of(np.random.default_rng([seed, number]))), Path(folder))
        body = RigidBody(Path(folder) / "joint.xml", "joint")
        logs = prepare([read_log(path, "joint") for path in paths], body)
    found = trace(logs, seed=number, law="lugre")
    # the least of the family is that of its largest surprise: one p-value a search
    p = min(row.p_value for row in found.last_look.rows)
    return {"number": number, "p": p, "added": [f.term.name for f in found.findings]}


def told(rows: list[dict[str, Any]]) -> str:
    """Histogram, test and false alarms."""
    p = np.array([row["p"] for row in rows])
    counts, edges = np.histogram(p, _BINS, (0.0, 1.0))
    lines = [
        f"{a:.1f} to {b:.1f}  {c:4d}  {'#' * round(200 * c / len(p))}"
        for c, a, b in zip(counts, edges[:-1], edges[1:], strict=True)
    ]
    test = kstest(p, "uniform")
    lines.append(f"{len(p)} searches: Kolmogorov-Smirnov {test.statistic:.3f}, p {test.pvalue:.2f}")
    lines.append(f"p below 0.05: {100 * np.mean(p < 0.05):.1f}%")
    lines.append(f"something added: {sum(bool(row['added']) for row in rows)}")
    return "\n".join(lines)


def main() -> None:
    """Run the searches, print the histogram."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--n", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="file of rows, written anew")
    asked = parser.parse_args()
    rows = []
    with ProcessPoolExecutor(asked.jobs) as pool, asked.out.open("w") as file:
        for row in pool.map(one, [asked.seed] * asked.n, range(asked.n)):
            rows.append(row)
            print(json.dumps(row), file=file, flush=True)
    print(told(rows))


if __name__ == "__main__":
    main()
