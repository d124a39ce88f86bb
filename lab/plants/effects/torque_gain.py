"""Motor constant wrong: the log shows (1 + error) times the true torque."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "torque-gain"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {"error": float(rng.uniform(0.06, 0.2) * rng.choice([-1.0, 1.0]))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.torque_gain = 1.0 + p["error"]
