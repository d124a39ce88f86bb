"""An encoder disc off its centre: measured q + amplitude sin(q + phase), once per turn."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "encoder-eccentricity"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {
        "amplitude": float(rng.uniform(0.015, 0.04)),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.eccentricity = (p["amplitude"], p["phase"])


QUANTITIES = ("position", "acceleration", "load")
