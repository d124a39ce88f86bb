"""A gap between motor and link: a shaft hinge held by a tendon with a dead band.

gap rad in all; the flanks are as stiff as `stiffness` N m/rad; encoder on the motor.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "backlash"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """0.3 to 1.5 degrees, flanks ten times stiffer than what the load bends over the gap."""
    gap = float(np.radians(rng.uniform(0.3, 1.5)))
    load = max(spec.gravity_torque, spec.inertia * 10.0, spec.friction.Fs)
    return {"gap": gap, "stiffness": 20.0 * load / gap}


def build(parts: Parts, p: dict[str, float]) -> None:
    damping = 0.3 * np.sqrt(p["stiffness"] * parts.spec.inertia)
    parts.shaft = {"damping": f"{0.02 * damping:.9g}"}
    half = 0.5 * p["gap"]
    parts.tendons.append(
        f'<fixed name="flanks" stiffness="{p["stiffness"]:.9g}" '
        f'springlength="{-half:.9g} {half:.9g}">'
        '<joint joint="shaft" coef="1"/></fixed>'
    )
