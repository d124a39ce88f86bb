"""What a plant may hide, and how large it is drawn."""

import math

import numpy as np

from .joint import Joint

# kind -> name of the effect, name of its number in `Plant.hidden`
KINDS: dict[str, tuple[str, str]] = {
    "delay": ("command-delay", "delay"),
    "limit": ("drive-limit", "limit"),
    "deadband": ("deadband", "deadband"),
    "threshold": ("duty-drop", "threshold"),
    "rate": ("command-rate", "rate"),
    "factor": ("gain-error", "factor"),
    "nothing": ("", ""),
}


def hide(kind: str, joint: Joint, rng: np.random.Generator) -> dict[str, float]:
    """Numbers of the hidden effect for this joint."""
    leg = joint.drive.emf == 0.0
    if kind == "delay":
        return {"delay": float(rng.uniform(0.006, 0.03) if leg else rng.uniform(0.01, 0.06))}
    if kind == "limit":
        return {"limit": float(rng.uniform(0.25, 0.75) * joint.firmware.limit)}
    if kind == "deadband":
        return {"deadband": float(rng.uniform(0.008, 0.03) if leg else rng.uniform(0.012, 0.05))}
    if kind == "threshold":
        return {"threshold": float(rng.uniform(0.06, 0.35)), "left": float(rng.uniform(0.2, 0.5))}
    if kind == "rate":
        return {"rate": float(rng.uniform(1.0, 4.0) if leg else rng.uniform(0.8, 3.0))}
    if kind == "factor":
        up = rng.random() < 0.5
        return {"factor": float(rng.uniform(1.15, 1.4) if up else rng.uniform(0.6, 0.87))}
    if kind == "nothing":
        return {}
    raise ValueError(f"unknown kind {kind!r}; there are {', '.join(KINDS)}")


def apply(joint: Joint, hidden: dict[str, float]) -> Joint:
    """The joint with the hidden numbers in its firmware or drive."""
    drive = {k: v for k, v in hidden.items() if k == "factor"}
    firmware = {k: v for k, v in hidden.items() if k != "factor"}
    return joint._replace(
        drive=joint.drive._replace(**drive), firmware=joint.firmware._replace(**firmware)
    )


def able(joint: Joint) -> bool:
    """Whether an output that is cut still lifts load and static friction."""
    firmware = joint.firmware
    left = firmware.left if math.isfinite(firmware.threshold) else 1.0
    strongest = joint.drive.gain * joint.drive.factor * firmware.limit * left
    return strongest > 1.1 * (joint.load.moment + joint.friction.static)
