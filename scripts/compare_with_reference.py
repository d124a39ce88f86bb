"""Compare the law with the independent reference on random motions.

Usage: python scripts/compare_with_reference.py [--motions 1000] [--seed 0] [--json]
       [--plot convergence.png]
Example: python scripts/compare_with_reference.py --motions 200
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from reference.integrated_solver import reference_torque
from reference.motions import random_motion, random_parameters

import frictionjoint
from frictionjoint.parameters import FrictionParameters


def convergence(plot: str) -> dict[str, list[float]]:
    """Errors, in Fs, of a sampled smooth motion at 250 to 4000 steps, against 64000; drawn."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    steps, errors = [250, 500, 1000, 2000, 4000], {}
    figure, axes = plt.subplots()
    for n in (1.0, 2.0, 6.0):
        p = FrictionParameters.symmetric(
            Fs=5.0, Fc=3.0, Vs=0.01, n=n, knots=((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))
        )
        ends = []
        for m in (*steps, 64000):
            t = np.linspace(0, 1, m + 1)
            ends.append(frictionjoint.friction_torque(p, t, 6e-4 * np.sin(7 * t))[:: m // 250])
        errors[f"n = {n:g}"] = [float(np.abs(e - ends[-1]).max() / 5.0) for e in ends[:-1]]
        axes.loglog(steps, errors[f"n = {n:g}"], "o-", label=f"n = {n:g}")
    axes.set(xlabel="steps", ylabel="largest error of Fh, in Fs", title="order of convergence")
    axes.legend()
    figure.savefig(plot)
    return errors


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--plot", help="PNG of the error against the number of steps")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    total, worst, over = Counter(), (0.0, -1), []
    for i in range(given.motions):
        rng = np.random.default_rng([given.seed, i])
        p = random_parameters(rng)
        time, position = random_motion(rng, p)
        wanted, events = reference_torque(p, time, position)
        got = frictionjoint.friction_torque(p, time, position)
        total += events
        error = np.abs(got - wanted) / max(p.Fs_pos, p.Fs_neg)
        worst = max(worst, (float(error.max()), i))
        if not error.max() <= 1e-6:
            k = int(np.argmax(~(error <= 1e-6)))
            over.append((i, k, float(error[k]), p.variant, p.virgin, p.n))
    result = {
        "motions": given.motions,
        "worst": worst[0],
        "worst_motion": worst[1],
        "over_1e-6": len(over),
        "events": dict(total),
        "first": over[:12],
    }
    if given.plot:
        result["errors_at_250_to_4000_steps"] = convergence(given.plot)
    print(json.dumps(result) if given.json else "\n".join(f"{k}: {v}" for k, v in result.items()))


if __name__ == "__main__":
    main()
