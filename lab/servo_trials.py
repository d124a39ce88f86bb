"""Servos of other authors through the loop: what their firmware hides, by name and by number.

    python lab/servo_trials.py --n 21 --seed 1 [--hand second] [--bands] [--out FILE.jsonl]

See `servo_hands.py` for the hands. Friction, gains, motions and what is hidden are drawn anew for
each: a delay of the target, a lower limit, a dead band, a drop of the duty, a slower target,
another gain, or nothing. A trial is right where exactly that effect of the drive is named, nothing
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
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from servo_hands import HANDS, JOINT, KINDS, NOTHING, Servo

from frictionjoint.control.kernel import COUNT
from frictionjoint.diagnose.by_motion import named_by_motion
from frictionjoint.diagnose.close_loop import explain
from frictionjoint.diagnose.finding import Trace
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.terms import drive_changes
from frictionjoint.refine.guard import held as in_band
from frictionjoint.replay.closed_loop import Course, closed_loop, courses_of, joint_model
from frictionjoint.simulate.one_joint import simulate

TORQUE_GAIN = "torque-gain"
OF_DRIVE = {effect.name for effect in DRIVE_EFFECTS}
DRAWS = 200


def trial(kind: str, servo: Servo, bands: bool) -> dict[str, Any]:
    """What was hidden, named and measured of one servo."""
    bodies = Bodies(servo.mjcf, JOINT, None)
    analysis = explain(servo.fitted, servo.kept, bodies, controller=servo.controller, refine=False)
    report, trace = analysis.report, analysis.trace
    drive = {a.effect: a.parameters for a in report.added if a.effect in OF_DRIVE}
    name, number = KINDS[kind]
    found = {n: p[number].value for n, p in drive.items() if n == name}
    others = {a.effect: a.parameters for a in report.added if a.effect not in OF_DRIVE}
    if kind == "factor" and not drive and TORQUE_GAIN in others:
        # a drive that gives another torque than its output says has either name
        found = {name: 1.0 / (1.0 + others[TORQUE_GAIN]["gain"].value)}
    off = abs(found[name] / servo.hidden[kind] - 1.0) if found else None
    loops = report.closed_loops
    told = {
        "kind": kind,
        "hidden": servo.hidden,
        "own": servo.own,
        "drive": {n: {k: x.value for k, x in p.items()} for n, p in drive.items()},
        "others": list(others),
        "right": set(drive) <= {name} and bool(found) == bool(name),
        "off": off,
        "mae": [x.mae.held_out for x in loops] if loops else None,
    }
    if bands:
        courses = courses_of(servo.fitted, bodies.of(servo.fitted), servo.controller)
        kept = courses_of(servo.kept, bodies.of(servo.kept), servo.controller)
        told |= _bands(trace, courses, kept)
        off_true = [np.abs(servo.truth(c.name, c) - c.position) for c in kept]
        told["true_mae"] = float(np.mean(np.concatenate(off_true)))
    return told


def _bands(found: Trace, courses: Sequence[Course], held: Sequence[Course]) -> dict[str, Any]:
    """Share of held-out positions within the band, and the error of the refined model."""
    before = len(found.findings)
    found, outcome = named_by_motion(found, courses, courses[0].run.load.armature)
    refined = outcome.found
    vector, x, spread = refined.vector, refined.values, refined.cov
    rng = np.random.default_rng(0)
    draws = rng.multivariate_normal(x, spread, DRAWS, method="eigh")
    models = [vector.fit(np.clip(draw, vector.low, vector.high)) for draw in draws]
    inside = []
    for course in held:
        runs = np.array(
            [
                course.at_samples(simulate(joint_model(f), course.changed(drive_changes(f.terms))))
                for f in models
            ]
        )
        count = course.run.block[COUNT]
        read, predicted = (np.round(x / count) for x in (course.position, runs))
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
    parser.add_argument("--hand", choices=HANDS, default="mujoco")
    parser.add_argument("--bands", action="store_true")
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    kinds = list(KINDS)
    told = []
    for i in range(asked.n):
        kind = kinds[i % len(kinds)]
        servo = HANDS[asked.hand](kind, np.random.default_rng([asked.seed, i]))
        one = trial(kind, servo, asked.bands)
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
    own = [x for x in told if x["own"]]
    if own:
        found = sum(x["own"] in (*x["others"], *x.get("by_motion", ())) for x in own)
        print(f"effects of the joint itself named: {found} of {len(own)}")
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
