"""Load of one joint for a simulation of it alone, from the rigid bodies of its model."""

import math
from collections.abc import Mapping

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.simulate.one_joint import COS, GX, GY, INERTIA, REST, ROWS, SIN, Load

# positions at which a load is evaluated: three determine its mean and its first harmonic
_TURNS = (0.0, 2.0 * np.pi / 3.0, -2.0 * np.pi / 3.0)


def load_of(
    body: RigidBody,
    velocity: Array | None = None,
    others: Mapping[str, tuple[Array, Array, Array]] | None = None,
) -> Load:
    """Load of a joint with a velocity, shape (n,), along the measured motion of other joints, their
    positions, velocities and accelerations by name, if there are any."""
    j = body.joint_id
    v = velocity if others and velocity is not None else np.zeros(1)
    none, one = np.zeros(len(v)), np.ones(len(v))
    stiffness = float(np.ravel(body.model.jnt_stiffness[j])[0])
    rest = float(body.model.qpos_spring[body.model.jnt_qposadr[j]])
    found = np.zeros((ROWS, len(v)))
    turns = _TURNS if not body.slide else (0.0,)
    torques = [body.torque(np.full(len(v), q), v, none, others) for q in turns]
    found[INERTIA] = body.torque(none, v, one, others).load - torques[0].load
    loads = [x.load - stiffness * (q - rest) for x, q in zip(torques, turns, strict=True)]
    if body.slide:
        found[REST] = loads[0]
    else:
        found[REST], found[COS], found[SIN] = _harmonic(loads)
        found[GX : GX + 3] = _harmonic([x.gx for x in torques])
        found[GY : GY + 3] = _harmonic([x.gy for x in torques])
    return Load(found, body.armature, stiffness, rest)


def _harmonic(x: list[Array]) -> tuple[Array, Array, Array]:
    """Mean, cosine and sine of a quantity known at `_TURNS`."""
    cosine = sum(2.0 / 3.0 * math.cos(q) * y for q, y in zip(_TURNS, x, strict=True))
    sine = sum(2.0 / 3.0 * math.sin(q) * y for q, y in zip(_TURNS, x, strict=True))
    return (x[0] + x[1] + x[2]) / 3.0, np.asarray(cosine), np.asarray(sine)
