"""Own friction level for each direction: 1 + part forward, 1 - part backward."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "direction-asymmetry"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {"part": float(rng.uniform(0.08, 0.2) * rng.choice([-1.0, 1.0]))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop["asymmetry"] = p["part"]
