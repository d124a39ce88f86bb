"""Rotor inertia that the model does not know: MuJoCo's `armature`, kg m^2."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "inertia-error"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """15 to 60 % of the nominal inertia."""
    return {"inertia": float(rng.uniform(0.15, 0.6) * (spec.inertia + spec.armature))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.extra_armature = p["inertia"]
