"""A voltage-driven motor, MuJoCo's `dcmotor`: torque = kt/R (V - kt v); the log has voltage_v.

kt N m/A, resistance ohm, both at the joint.
"""

from __future__ import annotations

import numpy as np

from ..parts import JOINT, Parts
from ..spec import PlantSpec

NAME = "back-emf"


def draw(rng: np.random.Generator, spec: PlantSpec) -> dict[str, float]:
    """Back-EMF slope kt^2/R of one to three times the viscous friction; full torque near 12 V."""
    slope = float(rng.uniform(1.0, 3.0) * spec.friction.sigma2)
    gain = (2.0 * spec.friction.Fs + spec.gravity_torque) / 12.0
    kt = slope / gain
    return {"kt": kt, "resistance": kt / gain}


def build(parts: Parts, p: dict[str, float]) -> None:
    gain = p["kt"] / p["resistance"]
    parts.actuators.append(
        f'<dcmotor name="motor" joint="{JOINT}" motorconst="{p["kt"]:.9g}" '
        f'resistance="{p["resistance"]:.9g}" input="voltage"/>'
    )
    control = parts.spec.controller
    parts.voltage = True
    parts.loop |= {
        "voltage": gain, "kp": control.kp / gain, "ki": control.ki / gain, "kd": control.kd / gain,
        "limit": control.limit / gain,
    }  # fmt: skip
