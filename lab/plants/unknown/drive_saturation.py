"""The drive gives less than the log says: beyond `limit` N m the torque is cut."""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "drive-saturation"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Cut at 55 to 75 % of what gravity and friction ask for."""
    need = spec.friction.Fs + spec.gravity_torque * np.sin(
        min(max(m.amplitude + abs(m.center) for m in spec.motions), 0.5 * np.pi)
    )
    return {"limit": float(rng.uniform(0.55, 0.75) * need)}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop["actual_limit"] = p["limit"]


QUANTITIES = ("torque", "load")
