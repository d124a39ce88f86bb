"""A mass on the link that the model does not know (a payload, or a wrong one).

mass kg at the link's centre, or 0.1 m out where the link has no arm.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "gravity-error"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    arm = spec.length or 0.1
    return {"mass": float(rng.uniform(0.3, 0.8) * spec.friction.Fc / (9.81 * arm))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.extra_mass = p["mass"]
    parts.loop["gravity"] = parts.spec.gravity_torque + 9.81 * p["mass"] * (
        parts.spec.length or 0.1
    )
