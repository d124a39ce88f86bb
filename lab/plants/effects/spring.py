"""A cable or hose that pulls the joint back: MuJoCo's joint `stiffness`.

stiffness N m/rad, rest angle rad.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "spring"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Up to 30 to 80 % of the Coulomb level at the end of the motion."""
    reach = max(m.amplitude for m in spec.motions)
    return {
        "stiffness": float(rng.uniform(0.3, 0.8) * spec.friction.Fc / reach),
        "rest": float(rng.uniform(-0.5, 0.5) * reach),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.joint |= {"stiffness": f"{p['stiffness']:.9g}", "springref": f"{p['rest']:.9g}"}
