"""The grid of cases: motions, sample rates, encoder counts, friction, torque held or not."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from .motion import MOTIONS, Motion

RATES = (50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 4000.0)
BITS = (12, 14, 16, 18, 20, 24)
CREEP = 1e-3  # rad/s, over which the Coulomb torque changes sign
LOGS, SECONDS = 3, 20.0


@dataclass(frozen=True)
class Spec:
    """Where a case lies in the grid; held: the net torque is constant between samples."""

    motion: str
    rate: float
    bits: int
    friction: bool
    held: bool

    @property
    def name(self) -> str:
        parts = [self.motion, f"{self.rate:g}-hz", f"{self.bits}-bit"]
        parts += ["friction"] * self.friction + ["held"] * self.held
        return "_".join(parts)


@dataclass(frozen=True)
class Friction:
    """Coulomb torque (N m), that is coulomb * tanh(v / CREEP), and viscosity (N m s/rad)."""

    coulomb: float
    viscous: float


@dataclass(frozen=True)
class Case:
    """logs: time_s, position_rad, torque_nm each; noise: rms of the torque's white noise, N m."""

    name: str
    logs: list[dict[str, np.ndarray]]
    J: float
    friction: Friction | None
    noise: float
    counts: int
    rate: float
    held: bool


def specs() -> list[Spec]:
    """The whole grid."""
    return [Spec(*x) for x in product(MOTIONS, RATES, BITS, (False, True), (False, True))]


def grid(
    rng: np.random.Generator, keep: Callable[[Spec], bool] = lambda spec: True
) -> Iterator[Case]:
    """Cases of the grid one after the other, only those that `keep` wants.

    A case's numbers depend on rng and its place in the grid, not on which others are kept.
    """
    seed = int(rng.integers(2**62))
    for place, spec in enumerate(specs()):
        if keep(spec):
            yield make(spec, np.random.default_rng([seed, place]))


def make(spec: Spec, rng: np.random.Generator) -> Case:
    """One case, its inertia, friction and noise drawn at random."""
    J = 10 ** rng.uniform(-2, 1)
    friction = None
    if spec.friction:
        coulomb = J * rng.uniform(2, 20)
        friction = Friction(coulomb, coulomb * rng.uniform(0.05, 0.5))
    counts = 2**spec.bits
    motions = [MOTIONS[spec.motion](rng, SECONDS) for _ in range(LOGS)]
    exact = [sampled(m, spec, J, friction) for m in motions]
    scale = J + np.sqrt(np.mean([np.square(torque).mean() for _, _, torque in exact]))
    noise = scale * 10 ** rng.uniform(-3, -2)
    logs = [
        {
            "time_s": t,
            "position_rad": np.round(q * counts / (2 * np.pi)) * 2 * np.pi / counts,
            "torque_nm": torque + rng.normal(0, noise, t.size),
        }
        for t, q, torque in exact
    ]
    return Case(spec.name, logs, J, friction, noise, counts, spec.rate, spec.held)


def sampled(motion: Motion, spec: Spec, J: float, friction: Friction | None):
    """Instants, exact position and exact torque of a log."""
    t = np.arange(int(SECONDS * spec.rate)) / spec.rate
    q, v, a = motion(t)
    if not spec.held:
        return t, q, J * a + friction_torque(friction, v)
    return held(t, q, v, J, friction)


def held(t, q, v, J: float, friction: Friction | None):
    """The motion with the same velocities at the samples and constant acceleration between.

    Its torque is the mean over the tick that begins at the sample; without friction it is constant
    there, the torque of a drive that holds it.
    """
    tick = t[1] - t[0]
    position = q[0] + np.r_[0.0, np.cumsum(0.5 * (v[:-1] + v[1:]) * tick)]
    torque = J * np.diff(v) / tick + mean_friction(friction, v[:-1], v[1:])
    return t[:-1], position[:-1], torque


def friction_torque(friction: Friction | None, v: np.ndarray) -> np.ndarray:
    if friction is None:
        return np.zeros_like(v)
    return friction.coulomb * np.tanh(v / CREEP) + friction.viscous * v


def mean_friction(friction: Friction | None, v0: np.ndarray, v1: np.ndarray) -> np.ndarray:
    """Mean over a tick in which the velocity goes evenly from v0 to v1."""
    middle = 0.5 * (v0 + v1)
    if friction is None:
        return np.zeros_like(middle)
    change = v1 - v0
    small = abs(change) < 1e-3 * CREEP  # the integral's quotient would cancel
    even = np.where(small, 1.0, change)
    integral = CREEP * (log_cosh(v1 / CREEP) - log_cosh(v0 / CREEP)) / even
    mean = np.where(small, np.tanh(middle / CREEP), integral)
    return friction.coulomb * mean + friction.viscous * middle


def log_cosh(x: np.ndarray) -> np.ndarray:
    return abs(x) + np.log1p(np.exp(-2 * abs(x))) - np.log(2)
