"""Friction of a shaft that two joints turn, with a level that varies with its angle.

A tendon's ``frictionloss`` is one number. The deviation of its level is stored in ``<custom>``
``<numeric name="frictionjoint-shaft:TENDON">`` and acts through the passive callback on both
joints. At rest it is zero, and the tendon's own level acts. A block is

    0 MAGIC   1 version   2 resolved   3, 4 qpos and dof address of one joint   5, 6 of the other
    7 turns of the shaft per turn of the other   8 waves along the shaft, 1/rad
    9, 10 sine and cosine, N m   11 speed at which the friction reverses, rad/s

Slots 2 to 6 belong to one compiled model, as those of a joint's block (`carrier`).
"""

import math

import mujoco
import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.errors import ModelError
from frictionjoint.simulate.block import MAGIC, VERSION, names_of, tagged_numerics
from frictionjoint.simulate.layout import ModelView

SHAFT = MAGIC + 1.0
SHAFT_TAG = "frictionjoint-shaft:"
_RESOLVED, _QPOS, _DOF, _OTHER_QPOS, _OTHER_DOF, _RATIO, _WAVES, _SIN, _COS, _TURNS_OVER = range(
    2, 12
)
_SIZE = _TURNS_OVER + 1


def add_wave(
    spec: mujoco.MjSpec,
    tendon: str,
    ratio: float,
    waves: float,
    sin: float,
    cos: float,
    turns_over: float,
) -> None:
    """Write the wave of a tendon over two joints into a spec; changed in place.

    Args:
        ratio: turns of the shaft per turn of the tendon's second joint; 1 for its first.
        waves: along the shaft, 1/rad. sin, cos: of the wave, N m.
        turns_over: speed at which the friction reverses, rad/s.
    """
    block = [SHAFT, VERSION, 0.0, 0.0, 0.0, 0.0, 0.0, ratio, waves, sin, cos, turns_over]
    spec.add_numeric(name=SHAFT_TAG + tendon, data=block, size=_SIZE)


def remove_waves(spec: mujoco.MjSpec) -> None:
    """Remove the waves of all tendons from a spec; changed in place."""
    for numeric in [n for n in spec.numerics if SHAFT_TAG in n.name]:
        spec.delete(numeric)


def wave_blocks(model: mujoco.MjModel | ModelView) -> dict[str, int]:
    """Address in ``numeric_data`` of each tendon's block, by the tendon's name."""
    return tagged_numerics(model, SHAFT_TAG)


def resolve_waves(model: mujoco.MjModel | ModelView) -> None:
    """Write addresses into a model's own blocks.

    Raises:
        ModelError: a damaged block, or one without a tendon over two hinges or slides.
    """
    tendons = names_of(model, "tendon")
    for name, at in wave_blocks(model).items():
        block, where = model.numeric_data[at : at + _SIZE], f"numeric {SHAFT_TAG}{name}"
        if block[0] != SHAFT or block[1] != VERSION:
            raise ModelError(f"{where} is no friction of a shaft: write the model again")
        if name not in tendons:
            raise ModelError(
                f"{where} names tendon {name!r}: the model has {', '.join(tendons) or 'none'}"
            )
        tendon = tendons.index(name)
        first = int(model.tendon_adr[tendon])
        joints = [int(j) for j in model.wrap_objid[first : first + int(model.tendon_num[tendon])]]
        if len(joints) != 2 or int(model.wrap_type[first]) != int(mujoco.mjtWrap.mjWRAP_JOINT):
            raise ModelError(f"{where}: tendon {name!r} does not couple two joints")
        for slot, joint in zip((_QPOS, _OTHER_QPOS), joints, strict=True):
            block[slot] = model.jnt_qposadr[joint]
            block[slot + 1] = model.jnt_dofadr[joint]
        block[_RESOLVED] = 1.0


def wave_losses(model: mujoco.MjModel) -> list[str]:
    """A sentence for each tendon with a wave, which other programs do not support."""
    found = []
    for name, at in wave_blocks(model).items():
        size = math.hypot(*model.numeric_data[at + _SIN : at + _COS + 1])
        found.append(f"{name}: the wave of {size:.3g} N m in its friction level")
    return found


def wave_level(model: mujoco.MjModel, at: int, turn: Array) -> Array:
    """Deviation of a level from its mean at angles of the shaft, rad, by the address of the block;
    N m, shape (n,)."""
    waves, sin, cos = model.numeric_data[at + _WAVES : at + _COS + 1]
    return np.asarray(sin * np.sin(waves * turn) + cos * np.cos(waves * turn))


@compiled
def resist(P: Vector, block: int, qpos: Vector, qvel: Vector, passive: Vector) -> None:
    """Subtract the deviation of the shaft's friction from both joints' torques, N m."""
    ratio = P[block + _RATIO]
    one, other = int(P[block + _QPOS]), int(P[block + _OTHER_QPOS])
    dof, other_dof = int(P[block + _DOF]), int(P[block + _OTHER_DOF])
    angle = P[block + _WAVES] * (qpos[one] + ratio * qpos[other])
    v = qvel[dof] + ratio * qvel[other_dof]
    level = P[block + _SIN] * math.sin(angle) + P[block + _COS] * math.cos(angle)
    F = level * math.tanh(v / P[block + _TURNS_OVER])
    passive[dof] -= F
    passive[other_dof] -= ratio * F
