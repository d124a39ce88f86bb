"""What a step of the exported C header costs.

    python scripts/benchmark_c.py [--model models/kuka_ir361_joint1.xml] [--steps 200000]

Motions at 1 kHz: sliding one way, a slow sine that reverses in sliding, and small reversals before
sliding. A step is one call of `frictionjoint_torque` at a later time. Nanoseconds a step, the least
of the repeats, counted in computing time; gcc -O2.
"""

import argparse
import dataclasses
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from frictionjoint.export.c import header
from frictionjoint.joint_friction import JointFriction
from frictionjoint.simulate.carrier import load_model, read_friction

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "examples"))

from c_header import Header  # noqa: E402

EXPONENTS = (1.0, 2.0, 1.5, 4.0)


def motions(reach: float, speed: float, steps: int) -> dict[str, tuple[np.ndarray, ...]]:
    """Time, position, velocity by name. reach: rad before sliding. speed: rad/s of sliding."""
    t = 1e-3 * np.arange(1, steps + 1)
    small = 0.3 * reach * (np.sin(7 * t) + 0.5 * np.sin(23.7 * t) + 0.25 * np.sin(61.3 * t))
    found = {"sliding": speed * t, "reversing": speed * np.sin(2 * t), "presliding": small}
    return {name: (t, q, np.gradient(q, t)) for name, q in found.items()}


def least(work: Callable[[], object], steps: int, repeats: int) -> float:
    """Nanoseconds a step."""
    times = []
    for _ in range(repeats):
        begin = time.process_time_ns()
        work()
        times.append(time.process_time_ns() - begin)
    return min(times) / steps


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--model", type=Path, default=ROOT / "models/kuka_ir361_joint1.xml")
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--repeats", type=int, default=7)
    asked = parser.parse_args()
    (first, *_) = read_friction(load_model(asked.model)).values()
    friction = {
        f"n {n:g}": JointFriction(dataclasses.replace(first.parameters, n=n)) for n in EXPONENTS
    }
    reach, speed = 2.0 * first.parameters.knots[0][0], first.parameters.Vs_pos
    print("| exponent | motion | ns |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        made = Header(header(friction, "friction.h"), Path(folder))
        for joint, name in enumerate(friction):
            for motion, (t, q, v) in motions(reach, speed, asked.steps).items():
                in_c = least(partial(made.torque, joint, t, q, v), len(t), asked.repeats)
                print(f"| {name} | {motion} | {in_c:.0f} |")


if __name__ == "__main__":
    main()
