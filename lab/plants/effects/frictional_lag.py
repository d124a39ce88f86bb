"""Sliding friction that follows the Stribeck curve late: tau dS/dt = S(v) - S.

After Hess and Soom 1990 (a pure delay there, a first-order lag here).
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "frictional-lag"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {"tau": float(rng.uniform(0.02, 0.08))}


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop["lag_tau"] = p["tau"]
