"""The load: a mass on an arm that swings in a plane, which may lean."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

GRAVITY = 9.81


class Load(NamedTuple):
    """Inertia and conservative torques of the joint, SI units."""

    inertia: float  # all that turns, armature included, kg m^2
    link: float  # what turns behind the gear, kg m^2
    moment: float  # largest gravity torque, N m
    hanging: float  # the arm hangs down at q = -hanging, rad
    spring: float  # cable or hose, N m/rad
    spring_rest: float  # rad


class Arm(NamedTuple):
    """The arm as a user would describe it."""

    mass: float  # kg
    length: float  # axis to centre of mass, m
    spin: float  # inertia about the centre of mass, kg m^2
    armature: float  # kg m^2
    tilt: float  # of the axis from the horizontal, rad
    hanging: float  # rad


@njit
def load_torque(load: Load, q: float) -> float:
    """Gravity and spring on the joint, N m."""
    gravity = -load.moment * math.sin(q + load.hanging)
    return gravity - load.spring * (q - load.spring_rest)


def energy(load: Load, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Kinetic and potential energy of the joint, J."""
    kinetic = 0.5 * load.inertia * v**2
    spring = 0.5 * load.spring * (q - load.spring_rest) ** 2
    return kinetic + spring - load.moment * np.cos(q + load.hanging)


def draw_arm(rng: np.random.Generator, moment: float, length: float, armature: float) -> Arm:
    """An arm of that gravity torque with the axis level; one in three leans."""
    mass = moment / (GRAVITY * length)
    spin = mass * length**2 * rng.uniform(0.01, 0.12)
    tilt = rng.uniform(0.3, 1.0) * rng.choice((-1, 1)) if rng.random() < 0.35 else 0.0
    hanging = rng.uniform(-1.2, 1.2) if rng.random() < 0.6 else 0.0
    return Arm(mass, length, float(spin), armature, float(tilt), float(hanging))


def load_of(arm: Arm) -> Load:
    """What the arm does to the joint."""
    link = arm.spin + arm.mass * arm.length**2
    moment = arm.mass * GRAVITY * arm.length * math.cos(arm.tilt)
    return Load(link + arm.armature, link, moment, arm.hanging, 0.0, 0.0)


def mjcf_of(arm: Arm, mass_factor: float = 1.0) -> str:
    """MJCF of the arm on a hinge "j"; `mass_factor` makes its mass and spin wrong.

    The body turns about x by the tilt, then about y by `hanging`; the hinge turns about its y.
    """
    cx, sx = math.cos(arm.tilt / 2), math.sin(arm.tilt / 2)
    cy, sy = math.cos(arm.hanging / 2), math.sin(arm.hanging / 2)
    quat = f"{cx * cy:.12g} {sx * cy:.12g} {cx * sy:.12g} {sx * sy:.12g}"
    spin = f"{arm.spin * mass_factor:.9g}"
    return f"""<mujoco model="second_servo">
  <compiler angle="radian"/>
  <option timestep="0.001" gravity="0 0 -{GRAVITY}"/>
  <worldbody>
    <body name="arm" quat="{quat}">
      <joint name="j" type="hinge" axis="0 1 0" armature="{arm.armature:.9g}"/>
      <inertial pos="0 0 {-arm.length:.9g}" mass="{arm.mass * mass_factor:.9g}"
                diaginertia="{spin} {spin} {spin}"/>
    </body>
  </worldbody>
</mujoco>
"""
