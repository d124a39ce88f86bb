"""What a plant may hide: the size of each effect, drawn at random, and what it needs to be seen."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .motion import RESTING, SHAKING, STYLES


@dataclass(frozen=True)
class Setting:
    """The joint and its motion, as far as an effect's size hangs on them. SI units."""

    inertia: float
    coulomb: float
    breakaway: float
    viscous: float
    stribeck_velocity: float
    gravity: float
    reach: float
    speed: float


@dataclass(frozen=True)
class Kind:
    """fields: of the joint that make the effect; needs: what the rest of the plant must offer.

    group: of two kinds in one group a plant hides only one, as one would cover the other.
    variable: outside the catalogue, the measured quantities that are the right report.
    """

    draw: Callable[[np.random.Generator, Setting], dict[str, float]]
    fields: tuple[str, ...]
    group: str = ""
    gravity: tuple[float, float] | None = None  # in units of the Coulomb torque
    frequency: tuple[float, float] = (1.0, 3.5)  # of the fastest sine, Hz
    liveliness: float = 1.0  # factor on acceleration
    speed: tuple[float, float] = (0.8, 4.0)
    counts: int = 13  # at least 2**counts
    rate: float = 100.0  # of the log, at least
    styles: tuple[str, ...] = STYLES
    quiet: float = 0.02  # most noise, in units of the Coulomb torque
    sharp_stribeck: bool = False
    variable: tuple[str, ...] = field(default=())


def sign(rng):
    return rng.choice([-1.0, 1.0])


def bias(rng, s):
    return {"bias": sign(rng) * rng.uniform(0.2, 0.5) * s.coulomb}


def inertia_error(rng, s):
    return {"inertia_error": rng.choice([rng.uniform(-0.35, -0.15), rng.uniform(0.15, 0.4)])}


def gravity_error(rng, s):
    size, angle = rng.uniform(0.25, 0.6) * s.coulomb, rng.uniform(0, 2 * np.pi)
    return {"gravity_cos": size * np.cos(angle), "gravity_sin": size * np.sin(angle)}


def spring(rng, s):
    k = rng.uniform(0.2, 0.5) * s.coulomb / s.reach
    return {"spring": k, "spring_centre": rng.uniform(-0.3, 0.3) * s.reach}


def load(rng, s):
    slow = rng.choice([0.0, rng.uniform(0.03, 0.15)])
    return {"load": rng.uniform(0.15, 0.4), "load_slow": slow}


def ripple(rng, s):
    order = rng.choice([3, 4, 6, 7, 8, 12, 14, 24, 30, 42])
    size = rng.uniform(0.1, 0.3) * s.coulomb
    second = size * rng.choice([0.0, rng.uniform(0.3, 0.7)])
    phase = rng.uniform(0, 2 * np.pi)
    return {
        "ripple": size, "ripple_second": second, "ripple_order": order, "ripple_phase": phase,
    }  # fmt: skip


def periodic_level(rng, s):
    order, phase = rng.choice([2, 3, 4, 6, 8, 12, 24]), rng.uniform(0, 2 * np.pi)
    return {"level": rng.uniform(0.15, 0.4), "level_order": order, "level_phase": phase}


def viscous_curve(rng, s):
    if rng.random() < 0.5:
        return {"quadratic": rng.uniform(0.4, 1.0) * s.coulomb / s.speed**2}
    p = rng.uniform(0.4, 0.6)
    return {"power": rng.uniform(0.7, 1.5) * s.coulomb / s.speed**p, "exponent": p}


def asymmetry(rng, s):
    viscous = sign(rng) * rng.uniform(0.1, 0.3)
    return {"asymmetry": sign(rng) * rng.uniform(0.08, 0.2), "asymmetry_viscous": viscous}


def heat(rng, s, seconds):
    """Heating that ends some 15 to 30 K above ambient, were the motion to go on."""
    power = 0.5 * s.speed * (s.coulomb + 0.5 * s.viscous * s.speed)
    return {"heating": rng.uniform(15, 30) / power / seconds, "cooling_time": seconds}


def temperature(rng, s):
    slopes = {"level_per_kelvin": rng.uniform(0.008, 0.02)}
    slopes["viscous_per_kelvin"] = rng.uniform(0.015, 0.035)
    return slopes | heat(rng, s, rng.uniform(20, 60))


def warm_up(rng, s):
    if rng.random() < 0.5:
        return {"warm_up": rng.uniform(0.3, 0.8), "warm_up_time": rng.uniform(5, 20)}
    slopes = {"level_per_kelvin": rng.uniform(0.015, 0.03)}
    slopes["viscous_per_kelvin"] = rng.uniform(0.02, 0.05)
    return slopes | heat(rng, s, rng.uniform(6, 15))


def elasticity(rng, s):
    link = rng.uniform(0.4, 0.7)
    w = 2 * np.pi * rng.uniform(5, 15)  # both inertias free
    k = w**2 * s.inertia * link * (1 - link)
    damping = 2 * rng.uniform(0.02, 0.08) * k / w
    return {"link": link, "coupling": k, "coupling_damping": damping}


def backlash(rng, s):
    link = rng.uniform(0.5, 0.75)
    w = 2 * np.pi * rng.uniform(40, 60)
    k = w**2 * s.inertia * link * (1 - link)
    damping = 2 * rng.uniform(0.05, 0.2) * k / w
    gap = rng.uniform(0.003, 0.009)
    return {"link": link, "coupling": k, "coupling_damping": damping, "gap": gap}


def lag(rng, s):
    return {"lag": rng.uniform(0.008, 0.03)}


def dwell(rng, s):
    growth = rng.uniform(0.3, 0.6) * s.coulomb
    return {
        "dwell": growth, "dwell_time": rng.uniform(0.2, 0.8), "memory": rng.uniform(4e-3, 12e-3),
    }  # fmt: skip


def stop(rng, s):
    k = rng.uniform(2.0, 5.0) * s.coulomb / s.reach
    return {"stop": rng.uniform(0.5, 0.7) * s.reach, "stop_stiffness": k}


def gain(rng, s):
    return {"gain": rng.choice([rng.uniform(-0.25, -0.1), rng.uniform(0.1, 0.3)])}


def gust(rng, s):
    size, phase = rng.uniform(0.25, 0.6) * s.coulomb, rng.uniform(0, 2 * np.pi)
    return {"gust": size, "gust_period": rng.uniform(2, 6), "gust_phase": phase}


def contact(rng, s):
    low = rng.uniform(-0.6, 0.1) * s.reach
    high = low + rng.uniform(0.3, 0.6) * s.reach
    size = rng.uniform(0.3, 0.7) * s.coulomb
    return {
        "contact": size, "contact_low": low, "contact_high": high,
        "contact_stiffness": size / rng.uniform(2e-3, 8e-3),
    }  # fmt: skip


def of_the_log(rng, s):
    """Delay, eccentric encoder, saturation and ageing are made where logs are made."""
    return {}


LOADED = (1.5, 4.0)
MILD = (0.3, 1.2)

CATALOGUE = {
    "torque-bias": Kind(bias, ("bias",), "even"),
    "inertia-error": Kind(inertia_error, ("inertia_error",), "mass", liveliness=2.0, counts=15),
    "gravity-error": Kind(gravity_error, ("gravity_cos", "gravity_sin"), "even"),
    "spring": Kind(spring, ("spring",), "even"),
    "load-dependent": Kind(load, ("load", "load_slow"), "load", gravity=LOADED),
    "position-periodic": Kind(ripple, ("ripple", "ripple_second"), "periodic", counts=15),
    "periodic-friction": Kind(periodic_level, ("level",), "periodic", counts=15),
    "nonlinear-viscous": Kind(
        viscous_curve, ("quadratic", "power"), "viscous", speed=(3.0, 6.0), liveliness=2.0
    ),
    "direction-asymmetry": Kind(asymmetry, ("asymmetry", "asymmetry_viscous"), "even"),
    "temperature-dependent": Kind(
        temperature, ("level_per_kelvin", "viscous_per_kelvin"), "heat", speed=(2.0, 5.0)
    ),
    "warm-up-drift": Kind(
        warm_up, ("warm_up", "level_per_kelvin", "viscous_per_kelvin"), "heat", speed=(2.0, 5.0)
    ),
    "measurement-delay": Kind(of_the_log, (), "fast", liveliness=2.0, counts=15),
    "joint-elasticity": Kind(
        elasticity, ("link",), "fast", gravity=MILD, frequency=(8.0, 15.0), liveliness=5.0,
        counts=17, rate=200.0, styles=SHAKING,
    ),
    "backlash": Kind(
        backlash, ("gap",), "fast", gravity=MILD, frequency=(2.0, 5.0), liveliness=2.0,
        counts=16, rate=200.0, styles=("multisine", "point-to-point", "chirp", "triangle"),
    ),
    "frictional-lag": Kind(
        lag, ("lag",), "breakaway", liveliness=2.0, counts=15, rate=200.0, quiet=0.006,
        sharp_stribeck=True, styles=("multisine", "triangle", "chirp", "point-to-point"),
    ),
    "dwell-time": Kind(
        dwell, ("dwell",), "breakaway", quiet=0.006, counts=15, styles=RESTING, speed=(0.3, 1.2)
    ),
    "end-stop": Kind(stop, ("stop_stiffness",), "even", gravity=(0.0, 1.0)),
    "torque-gain": Kind(gain, ("gain",), "mass", gravity=LOADED, liveliness=2.0, counts=15),
}  # fmt: skip

OUTSIDE = {
    "eccentric-encoder": Kind(
        of_the_log, (), speed=(3.0, 7.0), liveliness=3.0, counts=16, quiet=0.01,
        variable=("position",),
    ),
    "drive-saturation": Kind(
        of_the_log, (), liveliness=2.0, variable=("torque", "load", "acceleration")
    ),
    "gust": Kind(gust, ("gust",), variable=("time",)),
    "stick-slip-contact": Kind(contact, ("contact",), variable=("position",)),
    "ageing": Kind(of_the_log, (), variable=("log", "time")),
}  # fmt: skip

ALL = CATALOGUE | OUTSIDE
# names under which the catalogue knows a kind, where they differ
NAMES = {"periodic-friction": "position-periodic"}
# a law with its own parameters for each direction takes these, so nothing may be left of them
ONE_SIDED = {
    "torque-bias": ["torque-bias", "direction-asymmetry"],
    "direction-asymmetry": ["direction-asymmetry", "torque-bias", "none"],
}


def compatible(first: str, second: str) -> bool:
    """Whether a plant may hide both."""
    groups = {CATALOGUE[first].group, CATALOGUE[second].group}
    styles = set(CATALOGUE[first].styles) & set(CATALOGUE[second].styles)
    return len(groups) == 2 and groups != {"load", "mass"} and len(styles) >= 2
