"""A rubbing seal outside the joint: a small body dragged through a soft spring.

The body slides on MuJoCo's `frictionloss` of level N m; the spring bends `reach` rad before.
"""

from __future__ import annotations

import numpy as np

from ..parts import JOINT, Parts
from ..spec import PlantSpec

NAME = "stick-slip-contact"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {
        "level": float(rng.uniform(0.3, 0.6) * spec.friction.Fc),
        "reach": float(rng.uniform(0.15, 0.4) * min(m.amplitude for m in spec.motions)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    stiffness = p["level"] / p["reach"]
    inertia = 0.01 * (parts.spec.inertia + parts.spec.armature)
    damping = np.sqrt(stiffness * inertia)
    parts.bodies.append(
        '<body name="seal"><joint name="seal" axis="0 1 0" '
        f'frictionloss="{p["level"]:.9g}" armature="{inertia:.9g}" damping="{0.1 * damping:.9g}"/>'
        '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/></body>'
    )
    parts.tendons.append(
        f'<fixed name="rubber" stiffness="{stiffness:.9g}" damping="{0.05 * damping:.9g}">'
        f'<joint joint="{JOINT}" coef="1"/><joint joint="seal" coef="-1"/></fixed>'
    )


QUANTITIES = ("position", "velocity")
