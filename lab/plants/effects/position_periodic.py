"""Cogging or ripple: a torque fixed in angle, from `cogging` of MuJoCo's `dcmotor`.

amplitude N m, cycles per radian of q, phase rad; torque = amplitude sin(cycles q + phase). With
`level` instead of amplitude (an eccentric gear) the friction level is multiplied by
1 + level sin(cycles q + phase).
"""

from __future__ import annotations

import numpy as np

from ..parts import JOINT, Parts
from ..spec import PlantSpec

NAME = "position-periodic"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """5 to 20 % of the friction, enough cycles for the motion to cross several."""
    reach = max(m.amplitude for m in spec.motions)
    cycles = float(rng.uniform(5.0, 30.0) / reach)
    additive = rng.uniform() < 0.75
    size = float(rng.uniform(0.08, 0.25))
    return {
        **({"amplitude": size * spec.friction.Fs} if additive else {"level": size}),
        "cycles": float(max(1, round(cycles))),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build(parts: Parts, p: dict[str, float]) -> None:
    """A dcmotor without input that only cogs; 1e-6 because 3.17 refuses a zero motor constant."""
    if "level" in p:
        parts.loop |= {
            "periodic_level": p["level"],
            "periodic_n": p["cycles"],
            "periodic_phase": p["phase"],
        }
        return
    parts.actuators.append(
        f'<dcmotor name="cogging" joint="{JOINT}" input="none" motorconst="1e-6" resistance="1" '
        f'cogging="{p["amplitude"]:.9g} {p["cycles"]:.9g} {p["phase"]:.9g}"/>'
    )
