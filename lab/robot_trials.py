"""Trials of shared causes: random arms in MuJoCo that hide none, one or two causes.

    python lab/robot_trials.py --n 100 --out robot_trials.jsonl
    python lab/robot_trials.py --n 0 --out robot_trials.jsonl        the table alone
    python lab/robot_trials.py --n 20 --without-rotors --out F       as a URDF, one link wrong

Arm number i has 2 to 7 joints and is drawn from the seed and i alone; a number that has a row is
not run again. Two logs of 12 s each. Judged: every hidden cause is named, on its body or joint,
with its size within 10% (a payload's mass within 5%), and nothing else is. Friction that depends on
the load of one joint is no shared cause: of such an arm none may be named. A payload on a link
whose own mass is wrong is one body to any log: then the mass of both together is judged.
"""

import argparse
import json
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from arms.arm import (
    Arm,
    geared,
    hide_coupling,
    hide_load_dependence,
    hide_mass,
    hide_payload,
    hide_rotor,
    hide_supply,
    hide_tilt,
    random_arm,
)
from arms.fitted import fitted_joints

from frictionjoint.errors import FrictionJointError
from frictionjoint.robot.settle import Settled
from frictionjoint.robot.shared import shared_causes

KINDS = (
    "payload",
    "rotor-inertia",
    "body-inertia",
    "base-tilt",
    "gear-coupling",
    "load-dependent",
    "torque-gain",
)
WITHIN = {"payload": 0.05}
SECONDS = 12.0


def arm_of(seed: int, number: int) -> Arm:
    """An arm and what it hides: a third nothing, a third one cause, a third two."""
    rng = np.random.default_rng([seed, number])
    arm = random_arm(int(rng.integers(1 << 31)), int(rng.integers(2, 8)))
    for kind in rng.permutation(KINDS)[: number % 3]:
        _hide(arm, str(kind), rng)
    return arm


def arm_without_rotors(seed: int, number: int) -> Arm:
    """An arm whose model has no rotor, as any URDF, and one link of another mass and centre."""
    rng = np.random.default_rng([seed, number])
    arm = random_arm(int(rng.integers(1 << 31)), int(rng.integers(2, 8)))
    geared(arm, rng.uniform(0.3, 1.5, len(arm.joints)))
    for joint in arm.joints:
        hide_rotor(arm, joint)
    body = f"link{rng.integers(2, len(arm.joints) + 1)}"
    hide_mass(arm, body, rng.uniform(1.3, 1.8), rng.uniform(-0.02, 0.02, 3))
    return arm


def _hide(arm: Arm, kind: str, rng: np.random.Generator) -> None:
    last = len(arm.joints)
    joint = str(rng.choice(arm.joints))
    if kind == "payload":
        hide_payload(arm, 10 ** rng.uniform(-0.5, 0.5), rng.uniform(-0.06, 0.06, 3))
    elif kind == "rotor-inertia":
        hide_rotor(arm, joint)
    elif kind == "body-inertia":
        hide_mass(arm, f"link{rng.integers(2, last + 1)}", rng.choice([0.7, 1.3, 1.5]))
    elif kind == "base-tilt":
        hide_tilt(arm, rng.uniform(0.03, 0.15), rng.uniform(0.0, 2.0 * np.pi))
    elif kind == "gear-coupling":
        hide_coupling(arm, float(rng.uniform(0.002, 0.01)))
    elif kind == "torque-gain":
        hide_supply(arm, rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.2))
    else:
        hide_load_dependence(arm, joint, rng.uniform(0.08, 0.2))


def searched(arm: Arm, number: int) -> Settled:
    """Shared causes in two logs."""
    joints = fitted_joints(arm, (2 * number, 2 * number + 1), SECONDS)
    return shared_causes(joints, arm.joints, map)


def said(found: Settled) -> list[dict[str, Any]]:
    """Name, place and values of each cause, and of effects that all joints are said to have."""
    settled = found.found
    causes = [
        {
            "cause": c.name,
            "place": list(c.place.values()),
            "values": {n: v for n, (v, _) in c.values(settled.original, x).items()},
            "ties": list(choice.evidence.ties),
        }
        for c, x, choice in zip(settled.causes, settled.numbers, found.choices, strict=True)
    ]
    return causes + [
        {
            "cause": common.term.name,
            "place": list(common.joints),
            "values": {n: x.value for n, x in common.parameters.items()},
            "ties": list(choice.evidence.ties),
        }
        for common, choice in found.common
    ]


def expected(arm: Arm) -> list[dict[str, Any]]:
    """What should be said: cause, place, the value judged and its size."""
    rows = []
    hidden = dict(arm.hidden)
    load, link = hidden.get("payload"), hidden.get("body-inertia")
    if load and link and load[0] == link[0]:
        del hidden["payload"]
        hidden["body-inertia"] = link[0], link[1] + load[1]
    for kind, what in hidden.items():
        if kind == "payload" or kind == "body-inertia":
            rows.append({"cause": kind, "place": [what[0]], "value": "mass", "size": what[1]})
        elif kind == "rotor-inertia":
            rows += [
                {"cause": kind, "place": [j], "value": "added", "size": x} for j, x in what.items()
            ]
        elif kind == "base-tilt":
            rows.append({"cause": kind, "place": [], "value": "angle", "size": what[0]})
        elif kind == "gear-coupling":
            rows.append({"cause": kind, "place": what[:2], "value": "level", "size": what[2]})
        elif kind == "torque-gain":
            rows.append({"cause": kind, "place": arm.joints, "value": "gain", "size": what})
    return json.loads(json.dumps(rows))


def judged(row: dict[str, Any]) -> dict[str, Any]:
    """Which causes are right, and how many are false."""
    open_ones = list(row["said"])
    right = 0
    for want in row["expected"]:
        for one in open_ones:
            same = (one["cause"], one["place"]) == (want["cause"], want["place"])
            near = abs(one["values"].get(want["value"], 0.0) / want["size"] - 1.0)
            if same:
                right += near <= WITHIN.get(want["cause"], 0.1)
                open_ones.remove(one)
                break
    return {"hidden": len(row["expected"]), "right": right, "false": len(open_ones)}


def one(make: Callable[[int, int], Arm], seed: int, number: int) -> dict[str, Any]:
    """A row of the file."""
    warnings.simplefilter("ignore")
    begin, arm = time.process_time(), make(seed, number)
    row = {"number": number, "joints": len(arm.joints), "kinds": sorted(arm.hidden)}
    try:
        row |= {"expected": expected(arm), "said": said(searched(arm, number))}
        row |= judged(row)
    except FrictionJointError as error:
        row["error"] = str(error)
    return row | {"cpu_s": round(time.process_time() - begin, 1)}


def table(rows: list[dict[str, Any]]) -> str:
    """Counts by number of hidden causes."""
    lines = ["| hidden | arms | all right, nothing false | causes right | causes false |"]
    lines.append("|---|---|---|---|---|")
    for count in sorted({r["hidden"] for r in rows if "hidden" in r}):
        own = [r for r in rows if r.get("hidden") == count]
        clean = sum(r["right"] == count and not r["false"] for r in own)
        right, false = (sum(r[key] for r in own) for key in ("right", "false"))
        lines.append(
            f"| {count} | {len(own)} | {clean} | {right} of {count * len(own)} | {false} |"
        )
    failed = [r["number"] for r in rows if "error" in r]
    return "\n".join(lines) + (f"\nfailed: {failed}" if failed else "")


def main() -> None:
    """Run, append, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--n", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--without-rotors", action="store_true")
    asked = parser.parse_args()
    rows = [json.loads(x) for x in asked.out.read_text().splitlines()] if asked.out.exists() else []
    done = {r["number"] for r in rows}
    for number in range(asked.first, asked.first + asked.n):
        if number in done:
            continue
        make = arm_without_rotors if asked.without_rotors else arm_of
        row = one(make, asked.seed, number)
        rows.append(row)
        with asked.out.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(
            json.dumps({k: row.get(k) for k in ("number", "kinds", "right", "false")}), flush=True
        )
    print(table(rows))


if __name__ == "__main__":
    main()
