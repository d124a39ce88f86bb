"""Writes test joints of `lab/plants` as folders for `trials.py`.

    python lab/make_plants.py OUT --n 40 --seed 7
    python lab/make_plants.py OUT --n 6 --seed 7 --kinds none one:backlash two unknown:gust
    python lab/make_plants.py OUT --n 8 --seed 7 --slow --kinds none

Writes OUT/<number>/{fit1,fit2,fit3,held}.csv, model.xml (what the user believes about the joint)
and answer.json. A plant depends on the seed and its number only. Without --kinds, of five plants
one hides nothing, two one effect, one two, and one something outside the catalogue, on average.
With --slow their top speeds are 1.5 to 5 Stribeck velocities; otherwise 8 to 100.
"""

import argparse
import json
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from judging import OURS
from plants import catalogue
from plants.draw import draw_trial
from plants.plant import Trial, simulate, write
from plants.spec import Motion, PlantSpec

KINDS, ODDS = ("none", "one", "two", "unknown"), (0.2, 0.4, 0.2, 0.2)
# cause and effect of one thing: either name is right
SAME = (
    frozenset(("torque-bias", "direction-asymmetry")),
    frozenset(("temperature-dependent", "warm-up-drift")),
)


def answer(trial: Trial) -> dict[str, Any]:
    """The truth in the layout that `judging.read_answer` reads, and the test joint's numbers."""
    kinds = [effect.name for effect in trial.spec.effects]
    outside = [kind for kind in kinds if kind in catalogue.UNKNOWN]
    accept = {kind: sorted({kind}.union(*(s for s in SAME if kind in s))) for kind in kinds}
    accept |= {kind: sorted(catalogue.UNKNOWN[kind].also) for kind in outside}
    brings = []
    if "gravity-error" in accept:  # a mass that is added has inertia too
        brings = ["inertia-error"]
        accept["gravity-error"] = ["gravity-error", *brings]
    noise = trial.spec.instrument.torque_noise
    return {
        "family": OURS,
        "kinds": kinds,
        "accept": accept,
        "brings": brings,
        "variable": sorted({x for kind in outside for x in catalogue.UNKNOWN[kind].quantities}),
        "true_rms": {"fit": noise, "held_out": noise},
        "truth": trial.truth,
        "spec": asdict(trial.spec),
    }


def slow(spec: PlantSpec, rng: np.random.Generator) -> PlantSpec:
    """The same joint in motions of 1.5 to 5 Stribeck velocities, with amplitudes in proportion."""

    def slower(motion: Motion) -> Motion:
        speed = min(motion.speed, rng.uniform(1.5, 5.0) * spec.friction.Vs)
        amplitude = motion.amplitude * speed / motion.speed
        return replace(motion, speed=speed, amplitude=amplitude)

    return replace(spec, motions=tuple(map(slower, spec.motions)))


def write_plant(folder: Path, seed: int, number: int, kind: str, slowly: bool = False) -> Trial:
    """Draw, simulate, write; answer.json comes last, so a folder that has one is whole."""
    rng = np.random.default_rng([seed, number])
    spec = draw_trial(rng, kind)
    trial = simulate(slow(spec, rng) if slowly else spec)
    names = [*(f"fit{i}.csv" for i in range(1, len(trial.logs))), "held.csv"]
    write(trial, folder, names)
    (folder / "joint.xml").rename(folder / "model.xml")
    (folder / "answer.json").write_text(json.dumps(answer(trial), indent=1) + "\n")
    return trial


def main() -> None:
    """Write the test joints of a seed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--n", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", help="in turn; as lab/plants/draw.py names them")
    parser.add_argument("--slow", action="store_true", help="low speeds")
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    drawn = [str(rng.choice(KINDS, p=ODDS)) for _ in range(asked.n)]
    for number in range(asked.n):
        kind = asked.kinds[number % len(asked.kinds)] if asked.kinds else drawn[number]
        trial = write_plant(asked.out / f"{number:03d}", asked.seed, number, kind, asked.slow)
        hidden = " + ".join(effect.name for effect in trial.spec.effects)
        print(f"{number:03d}  {hidden or 'none'}", flush=True)


if __name__ == "__main__":
    main()
