"""``--to native``: an MJCF with the best approximation by MuJoCo's plain friction.

Coulomb friction is MuJoCo's constraint `frictionloss`, as stiff as MuJoCo allows: with the default
settings a joint under half the limit creeps at 0.05 rad/s, 10,000 times faster than with these.
Constant torques and springs become `stiffness` and `springref`, an inertia error `armature`.
"""

from collections.abc import Mapping

import mujoco
import numpy as np

from frictionjoint.errors import ModelError
from frictionjoint.export.sliding import PlainFriction


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
        _add_spring(joint, plain)
    return spec


def _add(joint: mujoco.MjsJoint, field: str, values: tuple[float, ...]) -> None:
    """Add coefficients to a polynomial, or to the single number of a MuJoCo without polynomials."""
    now = np.array(getattr(joint, field), dtype=np.float64)
    np.ravel(now)[: len(values)] += values
    setattr(joint, field, now if now.ndim else float(now))


def _add_spring(joint: mujoco.MjsJoint, plain: PlainFriction) -> None:
    before = float(np.ravel(joint.stiffness)[0])
    stiffness = plain.stiffness
    if plain.preload != 0.0 and before + stiffness == 0.0:
        # soft enough, 1/rad, to carry a constant torque
        stiffness = 1e-4 * abs(plain.preload)
    _add(joint, "stiffness", (stiffness,))
    if before + stiffness > 0.0:
        torque = before * joint.springref - plain.preload
        joint.springref = torque / (before + stiffness)
