"""Viscous friction and level falling with a temperature that the log records.

viscous N m s/rad and level (a fraction) at 25 C, both times exp(-(T - 25)/scale); T is a first
order thermal body heated by the friction loss: rise K, tau s.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "temperature-dependent"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """The friction's own loss warms the joint by 10 to 30 K in steady motion."""
    tau = float(rng.uniform(15.0, 60.0))
    return {
        "viscous": float(rng.uniform(1.0, 2.5) * spec.friction.sigma2),
        "level": float(rng.uniform(0.15, 0.4)),
        "rise": float(rng.uniform(12.0, 30.0)),
        "tau": tau,
        "scale": float(rng.uniform(15.0, 30.0)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    warming(parts, p)
    parts.log_temperature = True
    parts.start_temperatures = (25.0, 33.0, 41.0, 29.0)


def warming(parts: Parts, p: dict[str, float]) -> None:
    """A joint that its friction warms, from 25 C on."""
    speed = 0.5 * float(np.mean([m.speed for m in parts.spec.motions]))
    loss = (parts.spec.friction.Fc + parts.spec.friction.sigma2 * speed) * speed
    parts.loop |= {
        "visc_T": p["viscous"], "level_T": p["level"], "T0": p["scale"],
        "cooling_tau": p["tau"], "heat": p["rise"] / (p["tau"] * loss),
    }  # fmt: skip
