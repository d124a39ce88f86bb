"""Breakaway that grows while at rest: Fs + rise (1 - exp(-t/tau)), lost again over `slip` rad.

Rate-and-state ageing (Dieterich 1979) with an exponential instead of the logarithm.
"""

from __future__ import annotations

import numpy as np

from ..parts import Parts
from ..spec import PlantSpec

NAME = "dwell-time"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """30 to 80 % of Fs, over a fraction of a second to a second.

    The slip that wipes it out is some hundredths of a radian: over less, it is gone within a
    sample and no log shows it.
    """
    return {
        "rise": float(rng.uniform(0.3, 0.8) * spec.friction.Fs),
        "tau": float(rng.uniform(0.2, 1.0)),
        "slip": float(rng.uniform(0.01, 0.04)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    parts.loop |= {"dwell": p["rise"], "dwell_tau": p["tau"], "dwell_slip": p["slip"]}
