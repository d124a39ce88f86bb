"""A revolute joint: inertia, gravity, friction, and everything it may hide.

A hidden effect is absent where its field keeps the default. All in SI units and radians.
"""

from typing import NamedTuple

LAWS = ("lugre", "elasto-plastic", "dahl-stribeck", "tanh-maxwell")
NEVER = 1e9  # a limit that no motion reaches
AMBIENT = 22.0  # degrees Celsius, where the level is that of the friction law


class Joint(NamedTuple):
    """A named tuple, since numba takes it as an argument."""

    inertia: float
    gravity: float  # m g l; gravity torque is gravity * sin(q + tilt)
    tilt: float
    law: int  # index into LAWS
    coulomb: float
    breakaway: float
    stribeck_velocity: float
    stribeck_shape: float
    viscous: float
    stiffness: float  # presliding, N m/rad
    damping: float  # of the bristles, N m s/rad
    shape: float  # elasto-plastic: elastic part of the presliding; Dahl: exponent
    # known to the catalogue
    bias: float = 0.0
    inertia_error: float = 0.0  # fraction of `inertia` that the believed model lacks
    gravity_cos: float = 0.0
    gravity_sin: float = 0.0
    spring: float = 0.0
    spring_centre: float = 0.0
    load: float = 0.0  # level per transmitted torque, at any speed
    load_slow: float = 0.0  # the same, below the Stribeck velocity only
    ripple: float = 0.0
    ripple_second: float = 0.0  # amplitude of the second harmonic
    ripple_order: float = 1.0  # cycles a radian turned: q times order is the phase
    ripple_phase: float = 0.0
    level: float = 0.0  # periodic part of the friction level, a fraction
    level_order: float = 1.0
    level_phase: float = 0.0
    quadratic: float = 0.0
    power: float = 0.0
    exponent: float = 1.0
    asymmetry: float = 0.0
    asymmetry_viscous: float = 0.0
    level_per_kelvin: float = 0.0
    viscous_per_kelvin: float = 0.0
    heating: float = 0.0  # K/J
    cooling_time: float = 1.0
    warm_up: float = 0.0
    warm_up_time: float = 1.0
    link: float = 0.0  # fraction of the inertia behind the coupling
    coupling: float = 0.0  # N m/rad
    coupling_damping: float = 0.0
    gap: float = 0.0  # half the backlash, rad
    lag: float = 0.0
    dwell: float = 0.0
    dwell_time: float = 1.0
    memory: float = 1e-3  # slip that wipes out what a rest has built up, rad
    stop: float = NEVER
    stop_stiffness: float = 0.0
    gain: float = 0.0  # torque that acts = (1 + gain) * torque logged
    # outside the catalogue
    torque_limit: float = NEVER  # of the drive; the log holds what was asked
    gust: float = 0.0
    gust_period: float = 1.0
    gust_phase: float = 0.0
    contact: float = 0.0
    contact_low: float = 0.0
    contact_high: float = 0.0
    contact_stiffness: float = 0.0


DEFAULT = Joint._field_defaults


def without(joint: Joint, fields: tuple[str, ...]) -> Joint:
    """The joint with these effects absent."""
    return joint._replace(**{name: DEFAULT[name] for name in fields})
