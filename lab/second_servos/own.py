"""An effect of the joint itself that some plants have besides the hidden one."""

import numpy as np

from .joint import Joint

GRAVITY_ERROR = "gravity-error"


def draw_own(kind: str, leg: bool, rng: np.random.Generator) -> str:
    """Name of the effect, "" for two plants in three.

    A wrong mass is left to legs: a servo's torque constant is known from its load only, so there
    it shows as another constant. With a wrong factor of the torque it could not be told apart.
    """
    if rng.random() > 1 / 3:
        return ""
    choices = ["load-dependent", "direction-asymmetry", "spring"]
    if leg and kind != "factor":
        choices.append(GRAVITY_ERROR)
    return str(rng.choice(choices))


def add_own(joint: Joint, own: str, rng: np.random.Generator) -> Joint:
    """The joint with that effect; a wrong mass is in the MJCF and not in the joint."""
    if own == "load-dependent":
        share = float(rng.uniform(0.15, 0.4))
        return joint._replace(friction=joint.friction._replace(load=share))
    if own == "direction-asymmetry":
        share = float(rng.uniform(0.12, 0.3) * rng.choice((-1, 1)))
        return joint._replace(friction=joint.friction._replace(asymmetry=share))
    if own == "spring":
        stiffness = float(joint.torque_range * rng.uniform(0.04, 0.12))
        rest = float(rng.uniform(-0.5, 0.5))
        return joint._replace(load=joint.load._replace(spring=stiffness, spring_rest=rest))
    return joint


def mass_factor(own: str, rng: np.random.Generator) -> float:
    """Mass in the MJCF over the true one."""
    if own != GRAVITY_ERROR:
        return 1.0
    return float(1 + rng.uniform(0.15, 0.3) * rng.choice((-1, 1)))
