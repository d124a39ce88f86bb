"""Motor and link joined by a spring and damper: a second hinge, encoder on the motor.

stiffness N m/rad, damping N m s/rad. The rotor holds the armature, at least a fifth of the link.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "joint-elasticity"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Link resonance with the motor held between 4 and 12 Hz, lightly damped."""
    w = 2.0 * np.pi * float(rng.uniform(4.0, 12.0))
    stiffness = spec.inertia * w * w
    return {"stiffness": stiffness, "damping": 2.0 * 0.03 * stiffness / w}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.shaft = {"stiffness": f"{p['stiffness']:.9g}", "damping": f"{p['damping']:.9g}"}
