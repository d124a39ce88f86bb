"""Two families of devices: hobby servos under voltage, and leg joints under torque control."""

import math
from typing import NamedTuple

import numpy as np

from .drive import Drive
from .firmware import plain
from .friction import draw_friction
from .joint import Joint
from .load import Arm, draw_arm, load_of

TURN = 2 * math.pi


class Device(NamedTuple):
    """A joint that hides nothing yet, with what its user knows."""

    joint: Joint
    arm: Arm
    gains: tuple[float, ...]  # output per rad
    unit: float  # of the gains in the logs; 0 where the file gives the one gain itself
    controller: dict[str, object]
    log_hz: float


def _spread(rng: np.random.Generator, top: float) -> tuple[float, ...]:
    """Two or three gains up to `top`."""
    ratio = rng.uniform(1.4, 2.2)
    number = 2 if rng.random() < 0.5 else 3
    return tuple(float(top / ratio**i) for i in reversed(range(number)))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def draw_servo(rng: np.random.Generator) -> Device:
    """A DC motor with back-EMF behind a P or PD loop that puts out duty or voltage."""
    stall, free = _log_uniform(rng, 0.5, 5.0), float(rng.uniform(4, 10))
    armature = _log_uniform(rng, 0.002, min(0.05, 0.02 * stall))
    arm = draw_arm(
        rng, stall * float(rng.uniform(0.1, 0.35)), float(rng.uniform(0.08, 0.22)), armature
    )
    load = load_of(arm)
    friction = draw_friction(rng, stall, free, load.inertia)
    supply = float(rng.choice((5.0, 6.0, 7.4, 8.4, 11.1, 12.0)))
    volts = rng.random() < 0.35
    full = supply if volts else 1.0  # output that gives the stall torque
    derivative = rng.random() < 0.35
    softest = 0.12 if derivative else 0.2  # damping ratio of the motor's back-EMF alone
    top = min(stall / (load.inertia * (2 * free * softest) ** 2), _log_uniform(rng, 3, 12))
    gains = _spread(rng, full * max(top, 2.2))
    kd = 0.0
    if derivative:
        stiffness = gains[-1] / full * stall
        added = 2 * float(rng.uniform(0.1, 0.5)) * math.sqrt(stiffness * load.inertia)
        kd = added / stall * full
    rate = float(rng.choice((300, 400, 500, 800, 1000, 1500, 2000)))
    bits = int(rng.choice((12, 14)))
    limit = full * float(rng.choice((1.0, 1.0, 0.95, 0.9)))
    resolution = full / float(rng.choice((255, 500, 1023, 4096))) if rng.random() < 0.75 else 0.0
    firmware = plain(
        rate,
        float(rng.uniform(0, 1 / rate)),
        TURN / 2**bits,
        kd,
        limit,
        resolution,
        float(rng.uniform(30, 120)) if derivative else 0.0,
    )
    drive = Drive(stall / full, stall / free, 1.0)
    controller: dict[str, object] = {
        "output": "voltage_v" if volts else "duty",
        "kp": "log:kp",
        "limit": limit,
        "rate_hz": rate,
        "count_rad": TURN / 2**bits,
    }
    unit = 1.0
    if not volts:
        controller["supply_v"] = supply
    if derivative:
        controller |= {"kd": kd, "velocity": "differentiated"}
    elif rng.random() < 0.5:
        unit = gains[0] / float(rng.choice((4, 8, 16)))
        controller["gain_unit"] = unit
    joint = Joint(load, friction, drive, firmware, float(rng.uniform(2e-5, 5e-5)))
    return Device(joint, arm, gains, unit, controller, float(rng.choice((50, 80, 100, 125, 200))))


def draw_leg(rng: np.random.Generator) -> Device:
    """A torque-controlled joint on PD with measured speed."""
    strongest = _log_uniform(rng, 8, 60)
    armature = _log_uniform(rng, 0.004, 0.05)
    arm = draw_arm(
        rng, strongest * float(rng.uniform(0.1, 0.35)), float(rng.uniform(0.12, 0.35)), armature
    )
    load = load_of(arm)
    friction = draw_friction(rng, strongest, 6.0, load.inertia)
    top = strongest / float(rng.uniform(0.2, 0.7))
    several = rng.random() < 0.3
    gains = _spread(rng, top) if several else (top,)
    kd = 2 * float(rng.uniform(0.2, 0.7)) * math.sqrt(gains[-1] * load.inertia)
    rate = float(rng.choice((500, 800, 1000, 2000)))
    bits = int(rng.choice((14, 16, 17, 18)))
    firmware = plain(rate, float(rng.uniform(0, 1 / rate)), TURN / 2**bits, kd, strongest)
    controller: dict[str, object] = {
        "output": "torque_nm",
        "kp": "log:kp" if several else gains[0],
        "kd": kd,
        "limit": strongest,
        "rate_hz": rate,
        "count_rad": TURN / 2**bits,
    }
    joint = Joint(load, friction, Drive(1.0, 0.0, 1.0), firmware, float(rng.uniform(2e-5, 5e-5)))
    unit = 1.0 if several else 0.0
    return Device(joint, arm, gains, unit, controller, float(rng.choice((100, 200, 250, 500))))
