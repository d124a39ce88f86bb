"""A periodic torque in time, from outside (a fan, a pump, waves).

amplitude N m, frequency Hz, phase rad.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "gust"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    return {
        "amplitude": float(rng.uniform(0.2, 0.5) * spec.friction.Fc),
        "frequency": float(rng.uniform(0.3, 2.5)),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop |= {
        "gust_amp": p["amplitude"],
        "gust_freq": 2.0 * np.pi * p["frequency"],
        "gust_phase": p["phase"],
    }


QUANTITIES = ("time",)
