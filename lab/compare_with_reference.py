"""Compare the law with the independent reference on random motions.

Usage: python lab/compare_with_reference.py [--motions 1000] [--seed 0] [--json]
Example: python lab/compare_with_reference.py --motions 200
"""

import argparse
import json
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from reference.integrated_solver import reference_torque
from reference.motions import random_motion, random_parameters, violent_motion

import frictionjoint


def compare(motions: int, seed: int, violent: bool) -> dict[str, Any]:
    """Errors, in Fs, over random laws and motions; `violent` draws steps of 1e-12 to 1e3 rad."""
    total, worst, over = Counter(), (0.0, -1), []
    for i in range(motions):
        rng = np.random.default_rng([seed, i])
        p = random_parameters(rng)
        if violent:
            # the terms in v would dwarf Fh at 1e9 rad/s
            p = replace(p, sigma1=0.0, sigma2_pos=0.0, sigma2_neg=0.0)
        time, position = violent_motion(rng) if violent else random_motion(rng, p)
        wanted, events = reference_torque(p, time, position)
        got = frictionjoint.friction_torque(p, time, position)
        total += events
        error = np.abs(got - wanted) / max(p.Fs_pos, p.Fs_neg)
        worst = max(worst, (float(error.max()), i))
        if not error.max() <= 1e-6:
            k = int(np.argmax(~(error <= 1e-6)))
            over.append((i, k, float(error[k]), p.variant, p.virgin, p.n))
    return {
        "motions": motions,
        "worst": worst[0],
        "worst_motion": worst[1],
        "over_1e-6": len(over),
        "events": dict(total),
        "first": over[:12],
    }


def main() -> None:
    """Both kinds of motion, printed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=1000, help="of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    result = {
        "nested loops, slides and pauses": compare(given.motions, given.seed, violent=False),
        "steps of 1e-12 to 1e3 rad": compare(given.motions, given.seed, violent=True),
    }
    if given.json:
        print(json.dumps(result))
        return
    for kind, found in result.items():
        print(kind, *(f"  {k}: {v}" for k, v in found.items()), sep="\n")


if __name__ == "__main__":
    main()
