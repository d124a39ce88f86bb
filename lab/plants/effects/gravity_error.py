"""A mass on the link that the model does not know (a payload, or a wrong one).

mass kg, at the distance of the link's centre (0.1 m where the link has no arm), turned by `angle`
rad from it: straight below the centre, a mass cannot be told from a wrong torque gain.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import GRAVITY, PlantSpec

NAME = "gravity-error"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Up to 30 to 80 % of the Coulomb level, off to one side."""
    return {
        "mass": float(rng.uniform(0.3, 0.8) * spec.friction.Fc / (GRAVITY * spec.arm)),
        "angle": float(rng.uniform(0.7, 1.6) * rng.choice([-1.0, 1.0])),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.extra_mass, parts.extra_angle = p["mass"], p["angle"]
