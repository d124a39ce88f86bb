"""A constant torque the log does not show (offset of the amplifier or of the sensor)."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "torque-bias"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {"bias": float(rng.uniform(0.1, 0.4) * spec.friction.Fc * rng.choice([-1.0, 1.0]))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop["bias"] = p["bias"]
