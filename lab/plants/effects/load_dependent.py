"""Friction level that grows with the torque the gear hands on to the link.

slope: N m of friction per N m transmitted (Bittencourt and Gunnarsson 2012; Duclusaud et al. 2024).
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "load-dependent"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """5 % (harmonic drive) to 30 % (cheap servo) of the transmitted torque."""
    return {"slope": float(rng.uniform(0.08, 0.3))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop["load"] = p["slope"]
