"""Blind trials of the tracing: random plants, sealed answers, a confusion table.

    python scripts/blind_trials.py --trials 40 --jobs 2 --out trials
    python scripts/blind_trials.py --kind one:backlash --trials 5

Plants come from `scripts/plants` (MuJoCo's parts and other friction laws; see there). The logs of
a trial are written as a user would have them; the loop reads those and the believed MJCF, nothing
else. Truths go to DIR/sealed.json, written by the judge and read by nobody but the table.
"""

import argparse
import json
import os
import sys
import tempfile
import time
import warnings
from collections import Counter, defaultdict
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from plants import catalogue
from plants.draw import draw_trial
from plants.plant import simulate, write

KINDS = ("none", "one", "two", "unknown")
SHARES = (0.2, 0.4, 0.2, 0.2)
# Cause and effect of one thing: naming one for the other is a tie in the catalogue's own words.
TIED = {
    frozenset(("torque-bias", "direction-asymmetry")),
    frozenset(("temperature-dependent", "warm-up-drift")),
}


def one_trial(job: tuple[int, str]) -> dict[str, Any]:
    """Make one plant, show its logs to the loop, note what it said beside the truth."""
    seed, kind = job
    warnings.simplefilter("ignore")
    from frictionjoint.diagnose.loop import trace
    from frictionjoint.errors import FrictionJointError
    from frictionjoint.identify.fit import predict
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.rigid_body import RigidBody
    from frictionjoint.measured.readers import read_log

    trial = simulate(draw_trial(np.random.default_rng(seed), kind))
    result: dict[str, Any] = {"seed": seed, "kind": kind, "truth": trial.truth}
    begin = time.perf_counter()
    try:
        with tempfile.TemporaryDirectory() as folder:
            paths = write(trial, Path(folder))
            logs = [read_log(path, "joint") for path in paths]
            body = RigidBody(Path(folder) / "joint.xml", "joint")
            fitted_on = prepare(logs[:-1], body)
            kept = prepare(logs[-1:], body, fitted_on.segments[0].bandwidth_hz)
            found = trace(fitted_on, seed)
            errors = []
            for fitted in (found.base, found.final):
                measured, predicted = predict(kept, fitted)
                e = np.concatenate(measured) - np.concatenate(predicted)
                errors.append(float(np.sqrt(np.mean(e**2))))
    except FrictionJointError as error:
        return result | {"error": str(error)}
    return result | {
        "added": [s.term.name for s in found.steps],
        "ties": [list(s.ties) for s in found.steps],
        "unexplained": [r.name for r in found.unexplained],
        "before": errors[0],
        "after": errors[1],
        "seconds": time.perf_counter() - begin,
    }


def judge(results: list[dict[str, Any]]) -> dict[str, Any]:
    """Confusion table and the shares the project is held to."""
    table: dict[str, Counter[str]] = defaultdict(Counter)
    tally: dict[str, list[bool]] = defaultdict(list)
    for r in (r for r in results if "error" not in r):
        true = [e["name"] for e in r["truth"]["effects"]]
        said = list(dict.fromkeys(r["added"]))
        group = r["kind"].partition(":")[0]
        table["+".join(true) or "none"]["+".join(said) or "none"] += 1
        if group == "none":
            tally["none: effect added"].append(bool(said))
        elif group == "one":
            tally["one: named right"].append(_names(true[0], r))
            tally["one: named first"].append(said[:1] == true)
        elif group == "two":
            tally["two: both named"].append(all(_names(t, r) for t in true))
        else:
            quantities = catalogue.quantities(true[0])
            tally["unknown: not misnamed"].append(not said)
            tally["unknown: right quantity"].append(bool(set(quantities) & set(r["unexplained"])))
    return {
        "confusion": {k: dict(v) for k, v in sorted(table.items())},
        "shares": {k: [float(np.mean(v)), len(v)] for k, v in tally.items()},
        "refused": [r["error"] for r in results if "error" in r],
    }


def _names(true: str, result: dict[str, Any]) -> bool:
    said = set(result["added"]) | {t for ties in result["ties"] for t in ties}
    return true in said or any(frozenset((true, s)) in TIED for s in said)


def main() -> int:
    """Run the trials and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--kind", help="none, one, two, unknown, or one:<effect> ...; default all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--out", type=Path, help="folder for results.json and sealed.json")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    kinds = [arguments.kind or str(rng.choice(KINDS, p=SHARES)) for _ in range(arguments.trials)]
    jobs = [(1000 * arguments.seed + i, kind) for i, kind in enumerate(kinds)]
    results = []
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for result in pool.map(one_trial, jobs):
            results.append(result)
            if not arguments.json:
                true = "+".join(e["name"] for e in result["truth"]["effects"]) or "none"
                said = result.get("added", result.get("error"))
                print(f"{result['seed']:6d} {result['kind']:10s} {true:40s} {said}", flush=True)
    verdict = judge(results)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / "sealed.json").write_text(json.dumps([r["truth"] for r in results]))
        (arguments.out / "results.json").write_text(json.dumps(verdict | {"trials": results}))
    print(json.dumps(verdict, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
