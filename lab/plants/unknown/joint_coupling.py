"""A belt or cable to another joint: a fixed tendon over both, as a damper or a spring.

The other joint follows its own motion; its position is in the log.
"""

from __future__ import annotations

import numpy as np

from ..parts import JOINT, Parts
from ..spec import PlantSpec

NAME = "joint-coupling"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Torque of 20 to 50 % of the Coulomb level from the other joint's motion alone."""
    kind = float(rng.integers(2))
    return {"damper": kind, "torque": float(rng.uniform(0.25, 0.6) * spec.friction.Fc)}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.has_other = True
    parts.other_speed = 2.0
    rate = p["torque"] / (0.08 * (1.0 if p["damper"] else 0.7))
    kind = "damping" if p["damper"] else "stiffness"
    parts.tendons.append(
        f'<fixed name="belt" {kind}="{rate:.9g}"><joint joint="{JOINT}" coef="0.08"/>'
        '<joint joint="other" coef="1"/></fixed>'
    )


QUANTITIES = ("other.position", "other.velocity")
# a belt is a spring on its own joint too
ALSO = ("spring",)
