"""Take friction out of a model again."""

import mujoco
import numpy as np

from frictionjoint.arguments import require_spec
from frictionjoint.errors import ModelError
from frictionjoint.simulate.carrier import COUNT, HEAD, MAGIC, TAG, rows_of_block
from frictionjoint.simulate.mechanism import remove_mechanism
from frictionjoint.simulate.shaft_wave import remove_waves


def uninstall(spec: mujoco.MjSpec) -> list[str]:
    """Take all friction, and the user data and joints it needs, out of a spec.

    What else came with it stays: native friction that was cleared, an armature that was fitted, a
    motor, late sensors.

    Args:
        spec: changed in place.
    Returns:
        names of the joints that carried friction.
    Raises:
        ModelError: no joint does, or a block is damaged.
        TypeError: no spec.
    """
    require_spec(spec, "uninstall")
    ours = [numeric for numeric in spec.numerics if TAG in numeric.name]
    if not ours:
        raise ModelError("the model carries no friction: there is nothing to take out")
    rows = 0
    for numeric in ours:
        block = np.asarray(numeric.data)
        if len(block) <= HEAD or block[0] != MAGIC or len(block) != HEAD + 5 * block[COUNT]:
            raise ModelError(f"numeric {numeric.name} is damaged: delete it in the MJCF by hand")
        rows += rows_of_block(block.tolist())
    remove_waves(spec)
    joints = ["".join(numeric.name.split(TAG, 1)) for numeric in ours]
    for numeric in ours:
        spec.delete(numeric)
    for joint in joints:
        remove_mechanism(spec, joint)
    # the rows lie behind the user's own data
    spec.nuserdata = max(0, spec.nuserdata - rows)
    return joints
