"""Random trial plants, from micro servos to big arms, with motions that excite their effects.

    rng = np.random.default_rng(7)
    spec = draw_trial(rng, "none")            # or "one:backlash", "two", "two:spring,dwell-time",
                                              # "unknown:gust", "one", "unknown"
Kinds "one", "two" and "unknown" without a name draw the name too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import catalogue
from .spec import GRAVITY, LAWS, Controller, Friction, Instrument, Motion, PlantSpec

# Pairs that no motion parts, or only with a known load: not drawn together.
TIES = frozenset(
    frozenset(pair)
    for pair in (
        ("temperature-dependent", "warm-up-drift"),
        ("torque-gain", "gravity-error"),
        ("torque-gain", "inertia-error"),
        ("torque-gain", "load-dependent"),
        ("torque-bias", "gravity-error"),
        ("spring", "gravity-error"),
        ("spring", "torque-bias"),
        ("spring", "end-stop"),
        ("joint-elasticity", "backlash"),
        ("joint-elasticity", "inertia-error"),
        ("joint-elasticity", "measurement-delay"),
        ("frictional-lag", "measurement-delay"),
        ("frictional-lag", "dwell-time"),
    )
)
# Not drawn by plain "one" and "two": the base law has it already, or its log is another kind.
SPECIAL = frozenset(("direction-asymmetry", "back-emf"))
LAW_ODDS = (0.5, 0.15, 0.2, 0.15)
# A joint stuck on plain Coulomb friction does not move at all: its position says nothing of its
# torque, whatever the model. Such plants are kept moving.
MOVING = ("multisine", "ramps", "sines", "pick-and-place")
GENERAL = ("multisine", "pick-and-place", "ramps", "sines", "steps", "stick-slip", "dwell")
# Four motions each; the effect is at work in every one of them.
MOTIONS = {
    "inertia-error": ("multisine", "pick-and-place", "multisine", "steps"),
    "joint-elasticity": ("multisine", "steps", "multisine", "pick-and-place"),
    "measurement-delay": ("multisine", "pick-and-place", "sines", "steps"),
    "backlash": ("multisine", "pick-and-place", "sines", "multisine"),
    "frictional-lag": ("sines", "multisine", "sines", "multisine"),
    "dwell-time": ("dwell", "dwell", "dwell", "steps"),
    "temperature-dependent": ("multisine", "sines", "ramps", "multisine"),
    "warm-up-drift": ("multisine", "sines", "ramps", "multisine"),
    "nonlinear-viscous": ("ramps", "multisine", "sines", "ramps"),
    "position-periodic": ("ramps", "multisine", "sines", "pick-and-place"),
    "load-dependent": ("ramps", "multisine", "sines", "pick-and-place"),
    "gravity-error": ("ramps", "multisine", "sines", "pick-and-place"),
    "end-stop": ("sines", "ramps", "pick-and-place", "multisine"),
    "drive-saturation": ("sines", "ramps", "pick-and-place", "multisine"),
    "encoder-eccentricity": ("sines", "ramps", "pick-and-place", "multisine"),
}
LOADED = frozenset(("load-dependent", "torque-gain", "gravity-error", "drive-saturation",
                    "encoder-eccentricity"))  # fmt: skip
WARM = frozenset(("temperature-dependent", "warm-up-drift"))
SHAFTED = frozenset(("joint-elasticity", "backlash"))
DYNAMIC = frozenset(("inertia-error", "joint-elasticity", "measurement-delay", "torque-gain"))


def draw_trial(rng: np.random.Generator, kind: str) -> PlantSpec:
    """A random plant of the given kind (see the module's top). Raises ValueError on others."""
    names = _names(rng, kind)
    spec = _plant(rng, names)
    return replace(spec, effects=tuple(catalogue.draw(rng, spec, name) for name in names))


def _names(rng: np.random.Generator, kind: str) -> tuple[str, ...]:
    group, _, given = kind.partition(":")
    known = sorted(set(catalogue.EFFECTS) - SPECIAL)
    if group == "none":
        return ()
    if group in ("one", "two", "unknown") and given:
        return tuple(given.split(","))
    if group == "one":
        return (str(rng.choice(known)),)
    if group == "unknown":
        return (str(rng.choice(sorted(catalogue.UNKNOWN))),)
    if group == "two":
        while True:
            pair = tuple(str(name) for name in rng.choice(known, 2, replace=False))
            if frozenset(pair) not in TIES:
                return pair
    raise ValueError(f"trial kind {kind!r} is none of none, one, two, unknown (with :name)")


def _plant(rng: np.random.Generator, names: tuple[str, ...]) -> PlantSpec:
    wanted = set(names)
    fc = float(10.0 ** rng.uniform(-1.0, 1.5))
    speed = float(rng.uniform(1.5, 3.5))
    loaded = bool(wanted & LOADED) or rng.uniform() < 0.75
    length = float(rng.uniform(0.1, 0.5)) if loaded else 0.0
    gravity = fc * rng.uniform(1.0 if wanted & LOADED else 0.4, 3.0)
    mass = float(gravity / (GRAVITY * length)) if loaded else float(fc * rng.uniform(0.2, 1.0))
    least = fc * (0.06 if wanted & DYNAMIC else 0.02)
    inertia = float(1.1 * mass * length**2 + least * rng.uniform(1.0, 2.5))
    armature = float(inertia * rng.uniform(0.3, 0.8))
    friction = _friction(rng, fc, speed)
    if "dwell-time" in wanted and friction.law == "plain":
        # a stay at rest that no motion shows: see MOVING
        odds = np.array(LAW_ODDS[:-1]) / sum(LAW_ODDS[:-1])
        friction = replace(friction, law=str(rng.choice(LAWS[:-1], p=odds)))
    if "frictional-lag" in wanted:  # a lag shows only where the Stribeck curve is steep and wide
        friction = replace(friction, Fs=1.6 * fc, Vs=float(speed * rng.uniform(0.06, 0.15)))
    return PlantSpec(
        mass, length, inertia, armature, friction,
        _controller(rng, friction, inertia + armature, bool(wanted & SHAFTED)),
        _motions(rng, wanted, speed, loaded, friction.law == "plain"),
        _instrument(rng, friction), seed=int(rng.integers(2**31)),
    )  # fmt: skip


def _friction(rng: np.random.Generator, fc: float, speed: float) -> Friction:
    return Friction(
        law=str(rng.choice(LAWS, p=LAW_ODDS)),
        Fs=float(fc * rng.uniform(1.1, 1.7)),
        Fc=fc,
        Vs=float(speed * 10.0 ** rng.uniform(-2.0, -0.9)),
        delta=float(rng.choice([1.0, 2.0])),
        sigma2=float(fc * rng.uniform(0.1, 0.6) / speed),
        presliding=float(10.0 ** rng.uniform(-3.2, -2.3)),
    )


def _controller(
    rng: np.random.Generator, friction: Friction, inertia: float, shafted: bool
) -> Controller:
    """Stiff enough to follow within some hundredths of a radian; no integral across a gap."""
    kp = max(inertia * rng.uniform(12.0, 20.0) ** 2, friction.Fs / rng.uniform(0.02, 0.05))
    kd = 2.0 * rng.uniform(0.6, 1.0) * np.sqrt(kp * inertia)
    ki = 0.0 if shafted else kp * rng.choice([0.0, rng.uniform(0.5, 2.0)])
    return Controller(float(kp), float(kd), float(ki))


def _motions(
    rng: np.random.Generator, wanted: set[str], speed: float, loaded: bool, plain: bool
) -> tuple[Motion, ...]:
    """Four logs; the first effect with motions of its own decides, else four general kinds."""
    own = [MOTIONS[name] for name in sorted(wanted) if name in MOTIONS]
    general = MOVING if plain else GENERAL
    kinds = own[0] if own else tuple(str(k) for k in rng.choice(general, 4, replace=False))
    if len(own) > 1:
        kinds = (own[0][0], own[1][0], own[0][1], own[1][1])
    duration = rng.uniform(40.0, 60.0) if wanted & WARM else 10.0 ** rng.uniform(1.0, 1.5)
    amplitude = float(rng.uniform(0.7, 1.3))
    # the load changes sign across a gap only about the hanging position
    center = 0.0 if not loaded or wanted & SHAFTED else float(rng.uniform(-0.5, 0.5))
    if "frictional-lag" in wanted:
        speed = 0.4 * speed
    return tuple(
        Motion(
            kind, int(rng.integers(2**31)), amplitude, speed, float(round(duration, 1)),
            center, soft=0.1 if kind == "stick-slip" else 1.0,
        )
        for kind in kinds
    )  # fmt: skip


def _instrument(rng: np.random.Generator, friction: Friction) -> Instrument:
    """An encoder that sees presliding: at least 256 counts over it.

    The presliding stiffness turns one count into a torque error of about one per cent of Fs.
    """
    least = int(np.ceil(np.log2(2.0 * np.pi * 256.0 / friction.presliding)))
    return Instrument(
        rate=float(rng.choice([200.0, 250.0, 500.0, 1000.0])),
        counts=int(2 ** rng.integers(least, least + 3)),
        torque_noise=float(friction.Fc * 10.0 ** rng.uniform(-2.0, -1.3)),
        jitter=float(rng.choice([0.0, rng.uniform(0.01, 0.1)])),
    )
