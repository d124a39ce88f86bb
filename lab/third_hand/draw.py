"""Random joints, motions, controllers and instruments for the effects that a plant is to hide."""

from dataclasses import dataclass

import numpy as np

from . import control, instrument
from .control import CONTROLLERS, Controller
from .hidden import ALL, Kind, Setting
from .instrument import Instruments
from .joint import LAWS, Joint
from .motion import STYLES, Limits


@dataclass(frozen=True)
class Drawn:
    """All that a plant is before its noise; styles and warmth (K above ambient) one a log."""

    joint: Joint
    controller: Controller
    instruments: Instruments
    limits: Limits
    styles: tuple[str, str, str, str]
    warmth: tuple[float, float, float, float]
    dt: float
    thermometer: bool
    idle_thermometer: bool  # a temperature is logged that means nothing
    delay: float  # of the position, s
    ageing: float  # growth of the friction from log to log
    eccentric: float  # encoder error, rad
    eccentric_order: float
    eccentric_phase: float
    slow: bool

    def of_the_log(self) -> dict[str, object]:
        """What an answer states beside the joint itself."""
        names = ("delay", "ageing", "eccentric", "eccentric_order", "eccentric_phase", "dt")
        return {name: getattr(self, name) for name in names} | {"warmth": list(self.warmth)}


def draw(rng: np.random.Generator, kinds: tuple[str, ...]) -> Drawn:
    needs = [ALL[kind] for kind in kinds] or [ALL["torque-bias"]]
    plain, reach, speed = bare_joint(rng, needs)
    limits = motion_limits(rng, needs, plain, reach, speed)
    setting = Setting(
        plain.inertia, plain.coulomb, plain.breakaway, plain.viscous, plain.stribeck_velocity,
        plain.gravity, reach, speed,
    )  # fmt: skip
    hides: dict[str, float] = {}
    for kind in kinds:
        hides |= ALL[kind].draw(rng, setting)
    joint = plain._replace(**{name: float(x) for name, x in hides.items()})
    counts, rate = max(n.counts for n in needs), max(n.rate for n in needs)
    instruments = instrument.draw(rng, plain.coulomb, counts, rate, min(n.quiet for n in needs))
    hot = "temperature-dependent" in kinds
    eccentric_order = float(rng.choice([1, 2, 3, 4, 5, 8]))
    per_order = rng.uniform(0.06, 0.2) if "eccentric-encoder" in kinds else 0.0
    return Drawn(
        joint=joint,
        controller=control.draw(
            rng, str(rng.choice(CONTROLLERS)), plain.inertia, plain.gravity, plain.tilt,
            plain.coulomb,
        ),
        instruments=instruments,
        limits=limits,
        styles=draw_styles(rng, needs),
        warmth=tuple(rng.uniform(0, 18, 4)) if hot else (0.0,) * 4,
        dt=5e-5 if 1.5 * speed * plain.stiffness / plain.coulomb < 2e4 else 2.5e-5,
        thermometer=hot,
        idle_thermometer="warm-up-drift" not in kinds and bool(rng.random() < 0.25),
        delay=rng.uniform(1.5, 4.0) / instruments.rate if "measurement-delay" in kinds else 0.0,
        ageing=rng.uniform(0.08, 0.2) if "ageing" in kinds else 0.0,
        eccentric=per_order / eccentric_order,
        eccentric_order=eccentric_order,
        eccentric_phase=rng.uniform(0, 2 * np.pi),
        slow="dwell-time" in kinds,
    )  # fmt: skip


def bare_joint(rng: np.random.Generator, needs: list[Kind]) -> tuple[Joint, float, float]:
    """A joint that hides nothing, the reach (rad) and the speed (rad/s) of its motion."""
    inertia = 10 ** rng.uniform(-2.5, 0.7)
    coulomb = inertia * 10 ** rng.uniform(0.5, 1.4)
    sharp = any(n.sharp_stribeck for n in needs)
    breakaway = coulomb * (rng.uniform(1.6, 2.2) if sharp else rng.uniform(1.1, 1.7))
    stribeck = rng.uniform(0.08, 0.25) if sharp else rng.uniform(0.01, 0.08)
    loads = [n.gravity for n in needs if n.gravity]
    low, high = (max(x[0] for x in loads), min(x[1] for x in loads)) if loads else (0.3, 3.0)
    level = not loads and rng.random() < 0.15
    gravity = 0.0 if level else coulomb * rng.uniform(min(low, high), max(low, high))
    slow, fast = max(n.speed[0] for n in needs), min(n.speed[1] for n in needs)
    speed, reach = rng.uniform(min(slow, fast), max(slow, fast)), rng.uniform(0.5, 1.8)
    stiffness = breakaway / 10 ** rng.uniform(-3.7, -2.7)
    law = int(rng.integers(len(LAWS)))
    shape = {1: rng.uniform(0.4, 0.9), 2: rng.uniform(1.0, 2.0)}.get(law, 0.0)
    joint = Joint(
        inertia=float(inertia),
        gravity=float(gravity),
        tilt=float(rng.uniform(-np.pi, np.pi) if rng.random() < 0.5 else 0.0),
        law=law,
        coulomb=float(coulomb),
        breakaway=float(breakaway),
        stribeck_velocity=float(stribeck),
        stribeck_shape=float(rng.uniform(0.8, 2.0)),
        viscous=float(rng.uniform(0.2, 1.2) * coulomb / speed),
        stiffness=float(stiffness),
        damping=float(2 * rng.uniform(0.05, 0.4) * (stiffness * inertia) ** 0.5),
        shape=float(shape),
    )
    return joint, float(reach), float(speed)


def motion_limits(rng, needs: list[Kind], joint: Joint, reach: float, speed: float) -> Limits:
    """Fast enough to reach its speed, lively enough for the inertia to matter where it must."""
    lively = max(n.liveliness for n in needs)
    acceleration = joint.coulomb / joint.inertia * rng.uniform(1.0, 2.5) * lively
    acceleration = min(max(acceleration, 3.0 * speed), 150.0)
    low, high = max(n.frequency[0] for n in needs), max(n.frequency[1] for n in needs)
    return Limits(reach, speed, acceleration, rng.uniform(low, high))


def draw_styles(rng: np.random.Generator, needs: list[Kind]) -> tuple[str, str, str, str]:
    """Two styles for the logs to fit, another for the one held out."""
    fitting = [s for s in STYLES if all(s in n.styles for n in needs)]
    chosen = [str(s) for s in rng.permutation(fitting)]
    first, held = chosen[0], chosen[-1]
    return first, chosen[1] if len(chosen) > 2 else first, first, held
