"""Effects that the rigid body of an MJCF lacks: a constant torque, inertia, mass, a spring."""

from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import GX, GY, LOAD, A, Q, parts_of_load


@compiled
def bias_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c."""
    return P[e]


TORQUE_BIAS = Effect(
    name="torque-bias",
    title="constant torque offset",
    effect_id=1,
    kernel=bias_torque,
    coefficients=("bias",),
    plain=("preload",),
    units=("T",),
    cause="current sensor offset, preload of a seal or a balancer",
    form="c",
    source="Gautier (1997), offset term of the identification model",
    signature="constant, with the same sign in both directions",
    separating_motion="move through the same range in both directions and stop in between",
)


@compiled
def inertia_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """dJ a."""
    return P[e] * sig[A]


INERTIA_ERROR = Effect(
    name="inertia-error",
    title="wrong inertia",
    effect_id=3,
    kernel=inertia_torque,
    coefficients=("inertia",),
    plain=("armature",),
    units=("T s^2/x",),
    cause="rotor inertia through the gear, payload, wrong link inertia",
    form="dJ a",
    source="Armstrong, Khatib and Burdick (1986)",
    signature="proportional to acceleration at every frequency",
    separating_motion="fast motion at two frequencies at least a factor of two apart",
    needs=(A,),
    is_inertia=True,
)


@compiled
def gravity_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """mx Gx + my Gy, first moments of mass about the joint times unit gravity torques."""
    return P[e] * sig[GX] + P[e + 1] * sig[GY]


@compiled
def centred_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """m (cx Gx + cy Gy), in the direction (cx, cy) of the MJCF's own first moment."""
    return P[e + 2] * (P[e] * sig[GX] + P[e + 1] * sig[GY])


def _directions(signals: Array) -> list[Shape]:
    """Direction of the MJCF's first moment; none if gravity does not load the joint."""
    moment = parts_of_load(signals)[1:]
    loaded = np.ptp(signals[:, [GX, GY]] @ moment)
    # a moment this small, relative to the largest, has no direction
    if loaded <= 1e-6 * np.ptp(signals[:, LOAD]):
        return []
    # adding zero takes the sign off a zero
    # 12 decimals: less is rounding of the model's own numbers
    cx, cy = (np.round(moment / np.linalg.norm(moment), 12) + 0.0).tolist()
    return [(cx, cy)]


GRAVITY_ERROR = Effect(
    name="gravity-error",
    title="payload or wrong mass",
    effect_id=2,
    kernel=gravity_torque,
    coefficients=("moment_x", "moment_y"),
    units=("kg m", "kg m"),
    cause="payload, wrong mass or wrong centre of mass of everything beyond the joint",
    form="mx Gx(q) + my Gy(q); for a lone horizontal hinge a cos q + b sin q",
    source="first moments of the inverse dynamics, Atkeson, An and Hollerbach (1986)",
    signature="same sign in both directions, smooth in position with the period of one turn",
    separating_motion="slow motion over at least half a turn, both directions",
    needs=(GX, GY),
)
# a heavier link is one number, like a wrong motor constant
GRAVITY_ALONG_CENTRE = replace(
    GRAVITY_ERROR,
    effect_id=31,
    kernel=centred_torque,
    coefficients=("moment",),
    units=("kg m",),
    form="m (cx Gx + cy Gy), towards the model's own centre of mass",
    shape=("cx", "cy"),
    shape_units=("1", "1"),
    shape_fixed=2,
    shapes=_directions,
    needs=(GX, GY, LOAD),
)


@compiled
def spring_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """k q + c, with the rest position q0 = -c / k."""
    return P[e] * sig[Q] + P[e + 1]


SPRING = Effect(
    name="spring",
    title="spring or cable",
    effect_id=4,
    kernel=spring_torque,
    coefficients=("stiffness", "preload"),
    plain=("stiffness", "preload"),
    units=("T/x", "T"),
    cause="cable, hose, balancing spring",
    form="k (q - q0), stored as k q + c",
    source="linear elasticity",
    signature="same sign in both directions, linear in position over the whole range",
    separating_motion="slow motion over more than half a turn, both directions",
    bounds=((0.0, float("inf")), (-float("inf"), float("inf"))),
)
