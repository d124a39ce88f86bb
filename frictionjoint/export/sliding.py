"""Steady sliding: friction as a function of speed, which is all that most programs support.

A plain joint has a Coulomb torque, a damping that may be a polynomial of speed, and a constant
torque. Friction that differs between the directions becomes their mean and, exactly, half their
difference as a constant torque.

In MuJoCo, Coulomb friction is the constraint `frictionloss`, as stiff as MuJoCo allows: with the
default settings a joint under half the limit creeps at 0.05 rad/s, 10,000 times faster than with
these. Constant torques and springs become `stiffness` and `springref`, an inertia error `armature`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array
from frictionjoint.effects.effect import Plain
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import DT, N_SIGNALS, H, V
from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.stribeck import stribeck_level
from frictionjoint.parameter_checks import SIDES
from frictionjoint.parameters import Friction


@dataclass(frozen=True)
class PlainFriction:
    """The part of a joint's friction that a plain joint can represent.

    Attributes:
        coulomb: N m. breakaway: N m, at least the Coulomb torque.
        damping: coefficients of 1, |v|, v^2, times v; N m s/rad and so on, none negative.
        preload: N m, constant, against positive motion.
        stiffness: N m/rad, of a spring with rest position zero. armature: kg m^2, may be negative.
        lost: names of effects that a plain joint cannot represent.
    """

    coulomb: float
    breakaway: float
    damping: tuple[float, ...]
    preload: float
    stiffness: float
    armature: float
    lost: tuple[str, ...]


def levels(parameters: Friction) -> dict[str, tuple[float, ...]]:
    """Fs, Fc, Vs, delta, sigma2 of each direction, for any law."""
    return {side: tuple(parameters.levels(side)) for side in SIDES}


def stribeck_velocity(parameters: Friction) -> float | None:
    """The larger Stribeck velocity of the directions, rad/s; None if friction falls in neither."""
    falls = (Vs for Fs, Fc, Vs, *_ in levels(parameters).values() if Fs > Fc)
    return max(falls, default=None)


def speeds_above_stribeck(parameters: Friction) -> Array:
    """Speeds, rad/s, at which friction no longer falls, for programs with one dynamic friction."""
    both = levels(parameters)
    # where 1% of the fall from Fs to Fc is left
    lowest = max(Vs * np.log(100.0) ** (1.0 / delta) for _, _, Vs, delta, _ in both.values())
    return np.geomspace(lowest, 10.0 * lowest, 50)


def sliding_torque(carried: JointFriction, speeds: Array, side: str) -> Array:
    """Magnitude of the torque in steady sliding at these speeds, N m, shape (n,)."""
    level = np.array(levels(carried.parameters)[side])
    F = np.array([stribeck_level(level, 0, float(v)) for v in speeds]) + level[4] * speeds
    signals = np.zeros((len(speeds), N_SIGNALS))
    signals[:, V], signals[:, H], signals[:, DT] = speeds, 1.0, 1.0
    for effect in carried.effects:
        if effect.effect.of_speed:
            own = columns(effect.effect.effect_id, effect.shape, len(effect.coefficients), signals)
            F = F + own @ np.array(effect.coefficients)
    return np.asarray(F)


def plain_friction(carried: JointFriction, speeds: Array, terms: int = 1) -> PlainFriction:
    """The plain joint nearest to a joint's friction over given speeds, by least squares.

    Args:
        speeds: rad/s, > 0, as often as they occur. terms: most damping coefficients, used if the
            fit improves.
    Raises:
        ParameterError: no speed is above zero.
    """
    if not len(speeds):
        raise ParameterError("the motion has no speed above zero: friction cannot be fitted to it")
    up, down = (sliding_torque(carried, speeds, side) for side in ("pos", "neg"))
    found, misfit = _polynomial(speeds, 0.5 * (up + down), 1)
    if terms > 1:
        more, left = _polynomial(speeds, 0.5 * (up + down), terms)
        # a polynomial must reduce the misfit of a line by a tenth
        if left < 0.9 * misfit:
            found, misfit = more, left
    by_side = levels(carried.parameters)
    return PlainFriction(
        coulomb=found[0],
        breakaway=max(found[0], 0.5 * (by_side["pos"][0] + by_side["neg"][0])),
        damping=tuple(found[1:]),
        preload=float(np.mean(0.5 * (up - down))) + _total(carried, "preload"),
        stiffness=_total(carried, "stiffness"),
        armature=_total(carried, "armature"),
        lost=tuple(
            e.effect.name for e in carried.effects if not (e.effect.of_speed or e.effect.plain)
        ),
    )


def _polynomial(speeds: Array, F: Array, terms: int) -> tuple[list[float], float]:
    """Coefficients of 1, v, v^2 ..., none negative, and the rms residual."""
    top = float(speeds.max())
    scaled = (speeds / top)[:, None] ** np.arange(terms + 1)
    found, left = nnls(scaled, F)
    # smaller terms are not written
    used = np.flatnonzero(found > 1e-9 * found.max())
    last = max(2, used[-1] + 1 if len(used) else 0)
    coefficients = [float(x) for x in found[:last] / top ** np.arange(last)]
    return coefficients, float(left / np.sqrt(len(F)))


def _total(carried: JointFriction, part: Plain) -> float:
    """Sum of the effects' coefficients that represent this part of a plain joint."""
    return sum(
        coefficient
        for e in carried.effects
        for kind, coefficient in zip(e.effect.plain, e.coefficients, strict=False)
        if kind == part
    )


def add_plain(spec: mujoco.MjSpec, friction: Mapping[str, PlainFriction]) -> mujoco.MjSpec:
    """Add plain friction to joints; changed in place.

    Raises:
        ModelError: an inertia error makes an armature negative.
    """
    step = float(spec.option.timestep)
    for name, plain in friction.items():
        joint = spec.joint(name)
        joint.frictionloss += plain.coulomb
        if plain.coulomb > 0.0:
            # MuJoCo's largest impedance, and its shortest time constant, two steps
            joint.solimp_friction[:2] = 0.9999
            joint.solref_friction[:] = 2.0 * step, 1.0
        _add(joint, "damping", plain.damping)
        if joint.armature + plain.armature < 0.0:
            raise ModelError(
                f"joint {name!r}: its inertia error of {plain.armature:g} makes the armature "
                "negative: correct the inertia of the model's bodies first"
            )
        joint.armature += plain.armature
        before, stiffness = float(np.ravel(joint.stiffness)[0]), plain.stiffness
        if plain.preload != 0.0 and before + stiffness == 0.0:
            # soft enough, 1/rad, to carry a constant torque
            stiffness = 1e-4 * abs(plain.preload)
        _add(joint, "stiffness", (stiffness,))
        if before + stiffness > 0.0:
            torque = before * joint.springref - plain.preload
            joint.springref = torque / (before + stiffness)
    return spec


def _add(joint: mujoco.MjsJoint, field: str, values: tuple[float, ...]) -> None:
    """Add coefficients to a polynomial, or to the single number of a MuJoCo without polynomials."""
    now = np.array(getattr(joint, field), dtype=np.float64)
    np.ravel(now)[: len(values)] += values
    setattr(joint, field, now if now.ndim else float(now))
