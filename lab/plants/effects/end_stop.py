"""A soft stop at one end: a tendon with a dead band, k (q - at) beyond `at` rad."""

from __future__ import annotations

import numpy as np

from ..parts import JOINT, Parts
from ..spec import PlantSpec

NAME = "end-stop"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Met in the outer fifth of the motion; up to twice the Coulomb level at its end."""
    reach = max(m.amplitude for m in spec.motions)
    center = spec.motions[0].center
    at = float(center + rng.uniform(0.55, 0.7) * reach)
    return {"at": at, "stiffness": float(rng.uniform(1.5, 4.0) * spec.friction.Fc / (0.3 * reach))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.tendons.append(
        f'<fixed name="stop" stiffness="{p["stiffness"]:.9g}" springlength="-1000 {p["at"]:.9g}">'
        f'<joint joint="{JOINT}" coef="1"/></fixed>'
    )
