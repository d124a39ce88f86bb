"""How often the stated intervals hold the truth, on test joints with other friction laws than ours.

    python lab/interval_coverage.py --plants 60 --out coverage.jsonl
    python lab/interval_coverage.py --plants 0 --out coverage.jsonl   only the table

Test joints without an effect and with one, in turn, from `lab/plants`; the loop reads three of
their four logs, as in `trials.py`. A row per test joint is added to the file, and a seed that is
there is not run again. A plant counts where all its effects were named. Printed for the sandwich
over blocks of time alone, and for what the report states: the fraction of 95% intervals that
hold the truth, the median standard error over the truth, and how many intervals that is.
"""

import argparse
import json
import sys
import tempfile
import warnings
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from plants.answers import logged_friction
from plants.draw import draw_trial
from plants.plant import simulate, write

from frictionjoint.arrays import Array
from frictionjoint.diagnose.trace import trace
from frictionjoint.errors import FrictionJointError
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_estimates, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.readers import read_log

_NORMAL = 1.96
# an effect's coefficient, the test joint's number that it is, and their ratio
_OWN = {
    "torque-bias": ("bias", "bias", -1.0),
    "inertia-error": ("inertia", "inertia", 1.0),
    "torque-gain": ("gain", "error", 1.0),
    "spring": ("stiffness", "stiffness", 1.0),
    "load-dependent": ("c", "slope", 1.0),
    "measurement-delay": ("delay", "delay", 1.0),
    "position-periodic": ("N", "cycles", 1.0),
}


def one_plant(seed: int, kind: str) -> dict[str, Any]:
    """A row of the file: what is true, what was named, and every estimate next to its truth."""
    warnings.simplefilter("ignore")
    trial = simulate(draw_trial(np.random.default_rng(seed), kind))
    row = {"seed": seed, "kind": kind, "truth": trial.truth}
    try:
        with tempfile.TemporaryDirectory() as folder:
            paths = write(trial, Path(folder))
            body = RigidBody(Path(folder) / "joint.xml", "joint")
            found = trace(prepare([read_log(path, "joint") for path in paths[:-1]], body), seed)
    except FrictionJointError as error:
        return row | {"error": str(error)}
    return row | judged(found.prepared, found.final, trial.truth)


def judged(prepared: Prepared, fitted: Fit, truth: Mapping[str, Any]) -> dict[str, Any]:
    """What was named, and each estimate as [truth, value, stderr by blocks, stderr stated]."""
    blocks = make_blocks(prepared, fitted).of_sample
    said = [t.name for t in fitted.terms if isinstance(t, EffectTerm)]
    rows: dict[str, list[float]] = {}
    for cov in (by_blocks(fitted, blocks), covariance(prepared, fitted, blocks)):
        law = law_estimates(fitted, cov, prepared.slide)
        for name, (true, x) in _compared(fitted, law, cov, prepared, truth).items():
            rows.setdefault(name, [true, x.value]).append(x.stderr or float("nan"))
    return {"named": said, "gain_unknown": prepared.gain_unknown, "estimates": rows}


def _compared(
    fitted: Fit, law: Mapping[str, Any], cov: Array, prepared: Prepared, truth: Mapping[str, Any]
) -> dict[str, tuple[float, Any]]:
    effects = {e["name"]: e for e in truth["effects"]}
    found = {
        name: (true, law[f"{name}_pos"])
        for name, true in logged_friction(truth).items()
        if f"{name}_pos" in law
    }
    for i, term in enumerate(fitted.terms):
        if term.name in effects and term.name in _OWN:
            own, true, ratio = _OWN[term.name]
            x = term_estimates(fitted, cov, i, prepared.slide).get(own)
            if x is not None and true in effects[term.name]:
                found[f"{term.name}: {own}"] = (ratio * effects[term.name][true], x)
    return found


def by_blocks(fitted: Fit, block: Array) -> Array:
    """The sandwich over blocks of time alone, shape (p, p)."""
    J, e = fitted.jacobian * fitted.weight[:, None], fitted.residual * fitted.weight
    scale = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    bread = np.linalg.pinv((J / scale).T @ (J / scale), rcond=1e-10, hermitian=True)
    scores = np.zeros((block.max() + 1, J.shape[1]))
    np.add.at(scores, block, J / scale * e[:, None])
    n = len(scores)
    meat = scores.T @ scores * (n / (n - 1))
    return np.asarray(bread @ meat @ bread / np.outer(scale, scale))


def table(rows: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Coverage and width by parameter, both ways."""
    kept: dict[str, list[list[float]]] = defaultdict(list)
    for row in rows:
        true = {e["name"] for e in row["truth"]["effects"]}
        if "error" in row or row["gain_unknown"] or not true <= set(row["named"]):
            continue
        for name, numbers in row["estimates"].items():
            if np.all(np.isfinite(numbers)):
                kept[name if name in ("Fc", "sigma2") else "effects' own"].append(numbers)
    found = {}
    for name, several in sorted(kept.items()):
        true, value, *errors = np.array(several).T
        found[name] = {"intervals": len(several)}
        for word, error in zip(("blocks alone", "stated"), errors, strict=True):
            inside = np.abs(value - true) <= _NORMAL * error
            width = float(np.median(error / np.abs(true)))
            found[name][word] = {"95% holds": float(np.mean(inside)), "median width": width}
    return found


def main() -> int:
    """Run the test joints and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--plants", type=int, default=60)
    parser.add_argument("--seed", type=int, default=61000, help="of the first plant")
    parser.add_argument("--out", type=Path, required=True, help="file of rows, added to")
    arguments = parser.parse_args()
    text = arguments.out.read_text() if arguments.out.exists() else ""
    rows = [json.loads(line) for line in text.splitlines()]
    done = {row["seed"] for row in rows}
    for seed in range(arguments.seed, arguments.seed + arguments.plants):
        if seed in done:
            continue
        rows.append(one_plant(seed, ("none", "one")[seed % 2]))
        with arguments.out.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
        print(seed, rows[-1].get("error", rows[-1].get("named")), flush=True)
    print(json.dumps(table(rows), indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
