"""Effects that the catalogue lacks on purpose."""

from __future__ import annotations

import numpy as np

from .kind import Kind, Sizes, in_loop
from .parts import JOINT, Parts
from .spec import PlantSpec


def ageing(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Wear between logs: the friction level steps from one log to the next."""
    steps = 1.0 + np.array([-1.5, 1.5, -0.5, 0.5]) * rng.uniform(0.1, 0.2) * rng.choice([-1.0, 1.0])
    return {f"log{i}": float(s) for i, s in enumerate(steps)}


def build_ageing(parts: Parts, p: Sizes) -> None:
    """A level for each of the four logs."""
    parts.level_by_log = tuple(p[f"log{i}"] for i in range(4))


def drive_saturation(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Beyond `limit` N m the torque is cut, and the log does not say so.

    The limit is 55 to 75 % of what gravity and friction ask for.
    """
    need = spec.friction.Fs + spec.gravity_torque * np.sin(
        min(max(m.amplitude + abs(m.center) for m in spec.motions), 0.5 * np.pi)
    )
    return {"limit": float(rng.uniform(0.55, 0.75) * need)}


def encoder_eccentricity(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """An encoder disc off its centre: measured q + amplitude sin(q + phase), once per turn."""
    return {
        "amplitude": float(rng.uniform(0.015, 0.04)),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build_eccentricity(parts: Parts, p: Sizes) -> None:
    """The encoder's error."""
    parts.eccentricity = (p["amplitude"], p["phase"])


def gust(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """A periodic torque in time, from outside (a fan, a pump, waves): N m, Hz, rad."""
    return {
        "amplitude": float(rng.uniform(0.2, 0.5) * spec.friction.Fc),
        "frequency": float(rng.uniform(0.3, 2.5)),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build_gust(parts: Parts, p: Sizes) -> None:
    """A sine in the loop."""
    in_loop(gust_amp="amplitude", gust_phase="phase")(parts, p)
    parts.loop["gust_freq"] = 2.0 * np.pi * p["frequency"]


def joint_coupling(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Torque of 20 to 50 % of the Coulomb level from the other joint's motion alone."""
    kind = float(rng.integers(2))
    return {"damper": kind, "torque": float(rng.uniform(0.25, 0.6) * spec.friction.Fc)}


def build_coupling(parts: Parts, p: Sizes) -> None:
    """A belt or cable to another joint: a fixed tendon over both, as a damper or a spring.

    The other joint follows its own motion; its position is in the log.
    """
    parts.has_other = True
    parts.other_speed = 2.0
    rate = p["torque"] / (0.08 * (1.0 if p["damper"] else 0.7))
    kind = "damping" if p["damper"] else "stiffness"
    parts.tendons.append(
        f'<fixed name="belt" {kind}="{rate:.9g}"><joint joint="{JOINT}" coef="0.08"/>'
        '<joint joint="other" coef="1"/></fixed>'
    )


def stick_slip_contact(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Level, N m, and how far the spring bends before the body slides, rad."""
    return {
        "level": float(rng.uniform(0.3, 0.6) * spec.friction.Fc),
        "reach": float(rng.uniform(0.15, 0.4) * min(m.amplitude for m in spec.motions)),
    }


def build_seal(parts: Parts, p: Sizes) -> None:
    """A rubbing seal outside the joint: a small body dragged through a soft spring.

    The body slides on MuJoCo's `frictionloss`.
    """
    stiffness = p["level"] / p["reach"]
    inertia = 0.01 * (parts.spec.inertia + parts.spec.armature)
    damping = np.sqrt(stiffness * inertia)
    parts.bodies.append(
        '<body name="seal"><joint name="seal" axis="0 1 0" '
        f'frictionloss="{p["level"]:.9g}" armature="{inertia:.9g}" damping="{0.1 * damping:.9g}"/>'
        '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/></body>'
    )
    parts.tendons.append(
        f'<fixed name="rubber" stiffness="{stiffness:.9g}" damping="{0.05 * damping:.9g}">'
        f'<joint joint="{JOINT}" coef="1"/><joint joint="seal" coef="-1"/></fixed>'
    )


UNKNOWN = {
    "ageing": Kind(ageing, build_ageing, ("log", "time")),
    "drive-saturation": Kind(drive_saturation, in_loop(actual_limit="limit"), ("torque", "load")),
    "encoder-eccentricity": Kind(
        encoder_eccentricity, build_eccentricity, ("position", "acceleration", "load")
    ),
    "gust": Kind(gust, build_gust, ("time",)),
    # a belt is a spring on its own joint too
    "joint-coupling": Kind(
        joint_coupling, build_coupling, ("other.position", "other.velocity"), ("spring",)
    ),
    "stick-slip-contact": Kind(stick_slip_contact, build_seal, ("position", "velocity")),
}
