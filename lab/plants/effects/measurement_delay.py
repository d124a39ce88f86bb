"""Position recorded late against torque, by a fixed time in s."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "measurement-delay"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """1 to 3 samples, and at least 3 ms: below that nothing in the motion shows it."""
    return {
        "delay": float(max(rng.uniform(1.0, 3.0) / spec.instrument.rate, rng.uniform(3e-3, 8e-3)))
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.delay = p["delay"]
