"""Four position controllers; the drive holds their torque until the next tick."""

from typing import NamedTuple

import numpy as np
from numba import njit

CONTROLLERS = ("pid", "computed-torque", "cascade", "impedance")


class Controller(NamedTuple):
    """Gains in SI units; those that a controller lacks are zero."""

    kind: int  # index into CONTROLLERS
    proportional: float  # cascade: 1/s, from position to velocity
    derivative: float  # cascade: of the velocity loop
    integral: float
    inertia: float  # fed forward
    gravity: float  # fed forward at the measured angle
    tilt: float
    coulomb: float  # fed forward along the reference
    limit: float  # N m, meant not to be reached


@njit(cache=True)
def command(c, q, v, q_ref, v_ref, a_ref, integral, tick):
    """Torque and the integral carried to the next tick."""
    error = q_ref - q
    if c.kind == 2:
        rate = c.proportional * error + v_ref - v
        integral += rate * tick
        torque = c.derivative * rate + c.integral * integral
    else:
        integral += error * tick
        torque = c.proportional * error + c.derivative * (v_ref - v) + c.integral * integral
    torque += c.inertia * a_ref + c.gravity * np.sin(q + c.tilt)
    torque += c.coulomb * np.tanh(v_ref / 0.02)
    return min(max(torque, -c.limit), c.limit), integral


def draw(rng: np.random.Generator, kind: str, inertia, gravity, tilt, coulomb) -> Controller:
    """Gains of a loop that closes at a few hertz, from a model that is somewhat wrong."""
    wrong = rng.uniform(0.7, 1.3, 2)
    if kind == "impedance":
        w, zeta = 2 * np.pi * rng.uniform(1.2, 2.5), rng.uniform(0.6, 1.0)
    else:
        w, zeta = 2 * np.pi * rng.uniform(2.0, 5.0), rng.uniform(0.7, 1.1)
    gains = dict(proportional=inertia * w**2, derivative=2 * zeta * inertia * w, integral=0.0)
    forward = dict(inertia=0.0, gravity=0.0, coulomb=0.0)
    if kind == "pid":
        gains["integral"] = gains["proportional"] * rng.uniform(0.3, 1.5)
    elif kind == "computed-torque":
        friction = coulomb * rng.choice([0.0, rng.uniform(0.5, 1.0)])
        forward = dict(inertia=inertia * wrong[0], gravity=gravity * wrong[1], coulomb=friction)
    elif kind == "cascade":
        gains = dict(proportional=w / 2, derivative=2 * zeta * inertia * w)
        gains["integral"] = gains["derivative"] * w * rng.uniform(0.2, 0.5)
        forward["inertia"] = inertia * rng.choice([0.0, 0.8])
    else:
        forward = dict(inertia=inertia * wrong[0], gravity=gravity * wrong[1], coulomb=0.0)
    limit = 60.0 * (coulomb + abs(gravity))
    values = {name: float(x) for name, x in (gains | forward).items()}
    return Controller(CONTROLLERS.index(kind), tilt=float(tilt), limit=float(limit), **values)
