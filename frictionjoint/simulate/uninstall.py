"""Remove friction from a model."""

from collections.abc import Sequence

import mujoco
import numpy as np

from frictionjoint.arguments import require_spec
from frictionjoint.errors import ModelError
from frictionjoint.simulate import block as slot
from frictionjoint.simulate.block import TAG, have_rows, remove_assumed, rows_of_block, without_tag
from frictionjoint.simulate.mechanism import remove_mechanism
from frictionjoint.simulate.shaft_wave import remove_waves


def uninstall(spec: mujoco.MjSpec) -> list[str]:
    """Remove all friction, and the user data and joints it needs, from a spec.

    Other changes stay: cleared native friction, a fitted armature, a motor, delayed sensors.

    Args:
        spec: changed in place.
    Returns:
        names of the joints that had friction.
    Raises:
        ModelError: no joint has friction, or a block is damaged.
        TypeError: no spec.
    """
    require_spec(spec, "uninstall")
    joints = carrying(spec)
    if not joints:
        raise ModelError("the model has no friction: nothing to remove")
    take_out(spec, joints)
    remove_waves(spec)
    return joints


def carrying(spec: mujoco.MjSpec) -> list[str]:
    """Names of the joints that have friction."""
    found = (without_tag(numeric.name, TAG) for numeric in spec.numerics)
    return [name for name in found if name is not None]


def take_out(spec: mujoco.MjSpec, joints: Sequence[str], mechanism: bool = True) -> None:
    """Remove the friction of joints from a spec; changed in place.

    Args:
        mechanism: whether the joints behind elastic joints, and what is assumed, are removed too.
    Raises:
        ModelError: a block is damaged.
    """
    ours = [numeric for numeric in spec.numerics if without_tag(numeric.name, TAG) in joints]
    all_of_them = [numeric.data for numeric in spec.numerics if TAG in numeric.name]
    rows = 0
    for numeric in ours:
        block = np.asarray(numeric.data)
        n = len(block)
        if n <= slot.HEAD or block[0] != slot.MAGIC or n != slot.HEAD + 5 * block[slot.COUNT]:
            raise ModelError(f"numeric {numeric.name} is damaged: delete it in the MJCF by hand")
        rows += rows_of_block(block)
    if not have_rows(all_of_them, spec.nuserdata):
        rows = 0
    for numeric in ours:
        spec.delete(numeric)
    for joint in joints if mechanism else ():
        remove_mechanism(spec, joint)
        remove_assumed(spec, joint)
    # the rows lie behind the user's own data
    spec.nuserdata = max(0, spec.nuserdata - rows)
