"""Writes the plants of a seed; see the package's docstring."""

import argparse
import time
from pathlib import Path

from .files import write
from .hidden import ALL
from .plant import make
from .schedule import schedule


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m lab.third_hand", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--n", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", help="in turn; two of a plant joined by +; or none")
    asked = parser.parse_args()
    plans = schedule(asked.seed, asked.n)
    if asked.kinds:
        turns = [() if k == "none" else tuple(k.split("+")) for k in asked.kinds]
        strange = sorted({k for turn in turns for k in turn} - set(ALL))
        if strange:
            parser.error(f"no kind {', '.join(strange)}; there are none, {', '.join(ALL)}")
        plans = [turns[i % len(turns)] for i in range(asked.n)]
    for number, kinds in enumerate(plans):
        began = time.perf_counter()
        write(make(asked.seed, number, kinds), asked.out / f"{number:03d}")
        seconds = time.perf_counter() - began
        print(f"{number:03d}  {' + '.join(kinds) or 'none':45s} {seconds:5.1f} s", flush=True)


if __name__ == "__main__":
    main()
