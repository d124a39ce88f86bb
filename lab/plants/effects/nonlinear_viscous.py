"""Viscous friction that is not proportional to speed: c sgn(v) |v|^power.

Quadratic (churning) or concave (elastohydrodynamic films, power below 1).
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "nonlinear-viscous"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """30 to 70 % of the Coulomb level at top speed; concave or quadratic."""
    top = max(m.speed for m in spec.motions)
    power = float(rng.choice([rng.uniform(0.4, 0.6), rng.uniform(1.8, 2.2)]))
    return {"c": float(rng.uniform(0.3, 0.7) * spec.friction.Fc / top**power), "power": power}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop |= {"visc2": p["c"], "visc_p": p["power"]}
