"""Wear between logs: the friction level steps from one log to the next."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "ageing"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    steps = 1.0 + np.array([-1.5, 1.5, -0.5, 0.5]) * rng.uniform(0.1, 0.2) * rng.choice([-1.0, 1.0])
    return {f"log{i}": float(s) for i, s in enumerate(steps)}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.level_by_log = tuple(p[f"log{i}"] for i in range(4))


QUANTITIES = ("log", "time")
