"""Servos of another hand through the loop: what their firmware hides, by name and by number.

    python scripts/servo_trials.py --n 21 --seed 1 [--bands] [--out FILE.jsonl]

Each is simulated by MuJoCo with MuJoCo's own friction, its firmware written in
`tests/servo_plant.py`; friction, gains, motions and what is hidden are drawn anew. Hidden is one of
a delay of the target, a lower limit, a dead band, a drop of the duty, a slower target, another
gain, or nothing. Of a duty the gain is that of the motor, which no file says: plants with another
gain put out a torque. A trial is right where exactly that effect of the drive is named, nothing
where there is nothing; its number where it is within 10%.

--bands also refines the model, with what the motion asks for besides, as a report does. It counts
what is named so, draws two hundred parameter sets from the posterior, simulates the held-out logs
with each, and counts how many of their positions lie between the 2.5th and the 97.5th percentile of
those, all rounded as the encoder does (`guard.held`). The refined model's error on the held-out
logs is stated over a true model's: the plant itself, begun as the simulations of the model are and
given the log's own target.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.control.controller import Controller
from frictionjoint.diagnose.by_motion import named_by_motion
from frictionjoint.diagnose.close_loop import explain
from frictionjoint.diagnose.closed_loop import (
    Course,
    changes_of,
    closed_loop,
    courses_of,
    joint_model,
)
from frictionjoint.diagnose.finding import Trace
from frictionjoint.effects.catalogue import DRIVE_EFFECTS
from frictionjoint.identify.bodies import Bodies
from frictionjoint.refine.guard import held as in_band
from frictionjoint.simulate.one_joint import simulate

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from servo_plant import COUNT, KNOWN, KT, PLANT, SUPPLY, moved, servo, sines, steps, swept

# what is hidden: the effect's name, the number that is compared, and its range
KINDS: dict[str, tuple[str, str, float, float]] = {
    "delay": ("command-delay", "delay", 0.02, 0.06),
    "limit": ("drive-limit", "limit", 0.3, 0.6),
    "deadband": ("deadband", "deadband", 0.04, 0.1),
    "threshold": ("duty-drop", "threshold", 0.25, 0.5),
    "rate": ("command-rate", "rate", 1.5, 3.5),
    "factor": ("gain-error", "factor", 0.6, 1.6),
}
NOTHING = "nothing"
OF_DRIVE = {effect.name for effect in DRIVE_EFFECTS}
DRAWS = 200
# the plants' motor with its supply as one gain, N m a unit of duty
TORQUE = Controller(output="torque_nm", kp="log:kp", limit=KT * SUPPLY, count_rad=COUNT)


def trial(kind: str, rng: np.random.Generator, bands: bool) -> dict[str, Any]:
    """One plant: what was hidden, named and measured."""
    friction = (
        f'frictionloss="{rng.uniform(0.03, 0.15):.4f}" damping="{rng.uniform(0.01, 0.1):.4f}"'
    )
    gains = sorted(rng.choice([0.6, 1.0, 1.7, 3.0, 5.0], 3, replace=False).tolist())
    hidden: dict[str, float] = {}
    if kind != NOTHING:
        _, _, low, high = KINDS[kind]
        hidden[kind] = float(rng.uniform(low, high))
    if kind == "threshold":
        hidden["left"] = float(rng.uniform(0.2, 0.5))
    torque = kind == "factor" or (kind == NOTHING and rng.random() < 0.5)
    if torque:
        hidden["emf"] = 0.0
    logs = [
        servo(f"{m.__name__} {kp}", kp, m, hidden, friction=friction)
        for kp in gains
        for m in (steps, sines, swept)
    ]
    known = KNOWN
    if torque:
        known = TORQUE
        logs = [replace(x, metadata={"kp": KT * SUPPLY * x.metadata["kp"]}) for x in logs]
    kept = [x for x in logs if x.name.endswith(f" {gains[1]}")]
    fit = [x for x in logs if not x.name.endswith(f" {gains[1]}")]
    bodies = Bodies(PLANT.format(""), "j", None)
    report, found = explain(fit, kept, bodies, controller=known)
    drive = {a.effect: a.parameters for a in report.added if a.effect in OF_DRIVE}
    name, number = KINDS[kind][:2] if kind != NOTHING else ("", "")
    off = None
    if name in drive:
        off = abs(drive[name][number].value / hidden[kind] - 1.0)
    loops = report.closed_loops
    told = {
        "kind": kind,
        "hidden": hidden,
        "drive": {n: {k: x.value for k, x in p.items()} for n, p in drive.items()},
        "others": [a.effect for a in report.added if a.effect not in OF_DRIVE],
        "right": set(drive) == ({name} if name else set()),
        "off": off,
        "mae": [x.mae.held_out for x in loops] if loops else None,
    }
    if bands:
        held = courses_of(kept, bodies.of(kept), known)
        told |= _bands(found, courses_of(fit, bodies.of(fit), known), held)
        off_true = [
            np.abs(moved(c.target, gains[1], hidden, friction, c.run.start) - c.position)
            for c in held
        ]
        told["true_mae"] = float(np.mean(np.concatenate(off_true)))
    return told


def _bands(found: Trace, courses: Sequence[Course], held: Sequence[Course]) -> dict[str, Any]:
    """Share of held-out positions within the band, and the error of the refined model."""
    before = len(found.findings)
    found, outcome = named_by_motion(found, courses, courses[0].run.load.armature)
    vector, x, spread = outcome.vector, outcome.values, outcome.cov
    rng = np.random.default_rng(0)
    draws = rng.multivariate_normal(x, spread, DRAWS, method="eigh")
    models = [vector.fit(np.clip(draw, vector.low, vector.high)) for draw in draws]
    inside = []
    for course in held:
        runs = np.array(
            [
                course.at_samples(simulate(joint_model(f), course.changed(changes_of(f))))
                for f in models
            ]
        )
        read, predicted = (np.round(x / COUNT) for x in (course.position, runs))
        low, high = np.mean(predicted < read, axis=0), np.mean(predicted <= read, axis=0)
        inside.append(in_band(low, high))
    return {
        "by_motion": [x.term.name for x in found.findings[before:]],
        "inside": float(np.mean(np.concatenate(inside))),
        "refined_mae": closed_loop(held, vector.fit(x)).mae,
        "taken": outcome.taken,
    }


def main() -> None:
    """Run, count, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--n", type=int, default=21)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bands", action="store_true")
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    kinds = [*KINDS, NOTHING]
    told = []
    for i in range(asked.n):
        one = trial(kinds[i % len(kinds)], np.random.default_rng([asked.seed, i]), asked.bands)
        told.append(one)
        print(json.dumps(one), flush=True)
        if asked.out:
            asked.out.write_text("".join(json.dumps(x) + "\n" for x in told))
    named = Counter(x["kind"] for x in told if x["right"])
    near = Counter(x["kind"] for x in told if x["off"] is not None and x["off"] <= 0.1)
    print("| hidden | trials | right | within 10% |\n|---|---|---|---|")
    for kind in kinds:
        count = sum(x["kind"] == kind for x in told)
        number = near[kind] if kind != NOTHING else ""
        print(f"| {kind} | {count} | {named[kind]} | {number} |")
    if asked.bands:
        motion = Counter(name for x in told for name in x["by_motion"])
        listed = ", ".join(f"{name} {count}" for name, count in motion.items()) or "nothing"
        print(f"named by motion besides: {listed}")
        held = [x["inside"] for x in told]
        print(f"held-out positions within their band of 95%: {np.mean(held):.1%}, each of "
              f"{min(held):.1%} to {max(held):.1%}")  # fmt: skip
        over = [x["refined_mae"] / x["true_mae"] for x in told]
        print(f"refined error over a true model's: {min(over):.2f} at least, "
              f"{np.median(over):.2f} the median, {max(over):.2f} at most")  # fmt: skip


if __name__ == "__main__":
    main()
