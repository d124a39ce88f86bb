"""Blind trials of the tracing: random plants, sealed answers, a confusion table.

    python scripts/blind_trials.py --trials 40 --jobs 2 --out trials
    python scripts/blind_trials.py --kind one:backlash --trials 5

Plants come from `scripts/plants` (MuJoCo's parts and other friction laws; see there). The logs of
a trial are written as a user would have them; the loop reads those and the believed MJCF, nothing
else. Truths go to DIR/sealed.json, written by the judge and read by nobody but the table. Every
trial is added to DIR/trials.jsonl when it is done, and one that is there is not run again.
"""

import argparse
import contextlib
import json
import os
import sys
import tempfile
import time
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numba
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from plants import catalogue
from plants.answers import logged_friction
from plants.draw import draw_trial
from plants.perfect import truth_error
from plants.plant import Trial, simulate, write
from plants.spec import PlantSpec

from frictionjoint.effects.signals import TIME, A
from frictionjoint.identify.prepare import Segment
from frictionjoint.measured.derivatives import zero_phase

ROWS = "trials.jsonl"
KINDS = ("none", "one", "two", "unknown")
SHARES = (0.2, 0.4, 0.2, 0.2)
# parameters of the law compared with the plant's, by its names
_ESTIMATED = {"Fc_pos": "Fc", "sigma2_pos": "sigma2"}
# Cause and effect of one thing: naming one for the other is a tie in the catalogue's own words.
TIED = {
    frozenset(("torque-bias", "direction-asymmetry")),
    frozenset(("temperature-dependent", "warm-up-drift")),
}


def one_trial(job: tuple[int, str]) -> dict[str, Any]:
    """Make one plant, show its logs to the loop, note what it said beside the truth."""
    seed, kind = job
    warnings.simplefilter("ignore")
    from frictionjoint.diagnose.intervals import stated_covariance
    from frictionjoint.diagnose.loop import trace
    from frictionjoint.errors import FrictionJointError
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.rest import without_rest
    from frictionjoint.identify.result import law_estimates, law_parameters
    from frictionjoint.identify.rigid_body import RigidBody
    from frictionjoint.identify.start import predict
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
            if found.prepared.rest_speed > 0.0:  # a rest whose torque no position tells
                kept = without_rest(kept, found.prepared.rest_speed)
            errors = []
            for fitted in (found.base, found.final, found.other or found.final):
                errors.append(float(np.sqrt(np.mean(predict(kept, fitted).error ** 2))))
            cov = stated_covariance(found.prepared, found.final)
            estimates = law_estimates(found.final, cov, body.slide)
    except FrictionJointError as error:
        return result | {"error": str(error)}
    return result | {
        "gain_unknown": fitted_on.gain_unknown,
        "floor": noise_floor(trial.spec, fitted_on.segments[0]),
        "true_model": true_model_error(trial, kept.segments[0]),
        "law": law_parameters(found.final).law,
        "other_law": errors[2],
        "estimates": {
            name: [x.value, x.stderr] for name, x in estimates.items() if name in _ESTIMATED
        },
        "added": [s.term.name for s in found.steps],
        "ties": [list(s.ties) for s in found.steps],
        "unexplained": [r.name for r in found.unexplained],
        "before": errors[0],
        "after": errors[1],
        "seconds": time.perf_counter() - begin,
    }


def noise_floor(spec: PlantSpec, segment: Segment) -> float:
    """What the instruments alone leave of a perfect model, N m, behind the filters of the fit.

    The torque sensor's noise, and the encoder's quantum as white noise that the true inertia turns
    into torque.
    """
    rng = np.random.default_rng(0)
    sensor, encoder = rng.standard_normal((2, len(segment.drive)))
    torque = spec.instrument.torque_noise * segment.lowpass(sensor)
    quantum = 2.0 * np.pi / spec.instrument.counts
    position = zero_phase(quantum / np.sqrt(12.0) * encoder, segment.dt, segment.bandwidth_hz)
    acceleration = np.gradient(np.gradient(position, segment.dt), segment.dt)
    inertial = (spec.inertia + spec.armature) * segment.lowpass(acceleration, differenced=True)
    return float(np.hypot(torque.std(), inertial.std()))


def true_model_error(trial: Trial, held_out: Segment) -> float:
    """What the plant's own friction and link leave of the last log, driven by its motion, N m.

    Beside `noise_floor` it counts what samples and counts of the position do not tell of the
    motion. Nothing of the loop is in it but the kept samples and the filter.
    """
    time = held_out.signals[:, TIME] + trial.logs[-1]["time_s"][0]
    error = truth_error(trial, -1, time, held_out.signals[:, A])
    return float(np.sqrt(np.mean(held_out.lowpass(error)[held_out.kept] ** 2)))


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
            tally["unknown: not misnamed"].append(set(said) <= catalogue.also(true[0]))
            tally["unknown: right quantity"].append(bool(set(quantities) & set(r["unexplained"])))
    answered = [r for r in results if "error" not in r and not r["gain_unknown"]]
    known = [r for r in answered if r["kind"].partition(":")[0] != "unknown"]
    return {
        "confusion": {k: dict(v) for k, v in sorted(table.items())},
        "shares": {k: [float(np.mean(v)), len(v)] for k, v in tally.items()},
        "error after over noise floor, median": _median(
            [r["after"] / r["floor"] for r in answered]
        ),
        "the same without plants of unknown effects": _median(
            [r["after"] / r["floor"] for r in known]
        ),
        "error after over what a true model and the noise leave, without unknown effects": _median(
            [r["after"] / float(np.hypot(r["floor"], r["true_model"])) for r in known]
        ),
        "the same with the integrated law": _median(
            [r["other_law"] / r["floor"] for r in answered]
        ),
        "parameters": {name: _estimated(name, answered) for name in _ESTIMATED},
        "refused": [r["error"] for r in results if "error" in r],
    }


def _median(values: list[float]) -> float | None:
    return float(np.median(values)) if values else None


def _estimated(name: str, results: list[dict[str, Any]]) -> dict[str, float | None]:
    """How near an estimate came where all effects were named, and how often two of its errors."""
    near, covered = [], []
    for r in results:
        true = [e["name"] for e in r["truth"]["effects"]]
        if r["kind"].startswith("unknown") or not all(_names(t, r) for t in true):
            continue
        friction = logged_friction(r["truth"])
        if not friction:
            continue
        value, error = r["estimates"][name]
        truth = friction[_ESTIMATED[name]]
        near.append(abs(value / truth - 1.0))
        if error:
            covered.append(abs(value - truth) < 2.0 * error)
    share = float(np.mean(covered)) if covered else None
    return {"median relative error": _median(near), "within two standard errors": share}


def _names(true: str, result: dict[str, Any]) -> bool:
    said = set(result["added"]) | {t for ties in result["ties"] for t in ties}
    return true in said or any(frozenset((true, s)) in TIED for s in said)


def elsewhere(folder: str, job: tuple[int, str]) -> dict[str, Any]:
    """`one_trial` on a worker that shares this folder of scripts, under whatever name it runs."""
    import sys

    sys.path.insert(0, folder)
    from blind_trials import one_trial

    return one_trial(job)


def _on_one_thread() -> None:
    """Trials side by side fill the cores: threads within them would wait for each other."""
    numba.config.NUMBA_NUM_THREADS = 1


@contextlib.contextmanager
def _runner(scheduler: str | None, jobs: int) -> Iterator[Callable[..., Iterator[dict[str, Any]]]]:
    """What maps jobs to results in order: processes here, or workers of a Dask scheduler."""
    if scheduler is None:
        with ProcessPoolExecutor(jobs, initializer=_on_one_thread) as pool:
            yield lambda trials: pool.map(one_trial, trials)
        return
    from distributed import Client

    folder = str(Path(__file__).resolve().parent)
    with Client(scheduler) as client:
        yield lambda trials: (
            future.result() for future in client.map(partial(elsewhere, folder), trials)
        )


def _kept(out: Path | None, jobs: list[tuple[int, str]]) -> dict[tuple[int, str], dict[str, Any]]:
    """Results of these trials that a run before this one has left."""
    if out is None or not (out / ROWS).exists():
        return {}
    rows = (json.loads(line) for line in (out / ROWS).read_text().splitlines())
    by_job = {(row["seed"], row["kind"]): row for row in rows}
    return {job: by_job[job] for job in jobs if job in by_job}


def main() -> int:
    """Run the trials and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--kind", help="none, one, two, unknown, or one:<effect> ...; default all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--scheduler", help="address of a Dask scheduler to spread the trials over")
    parser.add_argument("--out", type=Path, help="folder for results.json and sealed.json")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    kinds = [arguments.kind or str(rng.choice(KINDS, p=SHARES)) for _ in range(arguments.trials)]
    jobs = [(1000 * arguments.seed + i, kind) for i, kind in enumerate(kinds)]
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
    found = _kept(arguments.out, jobs)
    with _runner(arguments.scheduler, arguments.jobs) as run:
        for result in run([job for job in jobs if job not in found]):
            found[result["seed"], result["kind"]] = result
            if arguments.out:
                with (arguments.out / ROWS).open("a") as rows:
                    rows.write(json.dumps(result) + "\n")
            if not arguments.json:
                true = "+".join(e["name"] for e in result["truth"]["effects"]) or "none"
                said = result.get("added", result.get("error"))
                print(f"{result['seed']:6d} {result['kind']:10s} {true:40s} {said}", flush=True)
    results = [found[job] for job in jobs]
    verdict = judge(results)
    if arguments.out:
        (arguments.out / "sealed.json").write_text(json.dumps([r["truth"] for r in results]))
        (arguments.out / "results.json").write_text(json.dumps(verdict | {"trials": results}))
    print(json.dumps(verdict, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
