"""Which kinds each plant of a seed hides, the same however many plants are asked for."""

import numpy as np

from .hidden import CATALOGUE, OUTSIDE, compatible

BLOCK = ("none",) * 4 + ("one",) * 9 + ("two",) * 4 + ("outside",) * 3


def schedule(seed: int, n: int) -> list[tuple[str, ...]]:
    """Of every 20 plants 4 hide nothing, 9 one effect, 4 two, 3 something outside the catalogue."""
    rng = np.random.default_rng([seed, 20_01])
    pools = {"one": list(CATALOGUE), "outside": list(OUTSIDE)}
    queues: dict[str, list[str]] = {"one": [], "outside": []}
    plants: list[tuple[str, ...]] = []
    while len(plants) < n:
        for sort in rng.permutation(BLOCK):
            if sort == "none":
                plants.append(())
            elif sort == "two":
                plants.append(pair(rng))
            else:
                if not queues[sort]:
                    queues[sort] = list(rng.permutation(pools[sort]))
                plants.append((str(queues[sort].pop()),))
    return plants[:n]


def pair(rng: np.random.Generator) -> tuple[str, str]:
    while True:
        first, second = rng.choice(list(CATALOGUE), 2, replace=False)
        if compatible(first, second):
            return str(first), str(second)
