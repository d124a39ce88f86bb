"""Room for friction in the user data of models that were put together after `install`.

``MjSpec.attach`` and MJCF's ``<attach>`` keep the parameters that a child model carries and drop
its ``nuserdata``. So a compiled model that lacks room gets it: MuJoCo lays out the next
``mujoco.MjData(model)`` by the model's ``nuserdata``. Data made before have too little, and the
callback leaves them alone (`native.lacks_room`); MuJoCo itself refuses to copy between the two.
"""

import warnings

import mujoco
import numpy as np

from frictionjoint.errors import ModelError
from frictionjoint.simulate.layout import data_structure, model_structure

_BYTES = np.dtype(float).itemsize
# models whose data were found to lack room, by address
_warned: set[int] = set()


def make_room(model: mujoco.MjModel, need: int) -> None:
    """Add numbers to a compiled model's user data for the friction; its own stay in front.

    Raises:
        ModelError: MuJoCo's reset of existing data would then write past the end of these data.
    """
    own, data = int(model.nuserdata), mujoco.MjData(model)
    fields = data_structure().from_address(data._address)
    behind = (fields.buffer or 0) + fields.nbuffer - (fields.userdata or 0)
    if behind < _BYTES * (own + need):
        raise ModelError(
            f'friction needs {need} numbers of user data: write <size nuserdata="{own + need}"/> '
            "in the MJCF, or set nuserdata of the spec"
        )
    model_structure().from_address(model._address).nuserdata = own + need
    _warned.discard(model._address)


def warn_of_no_room(address: int) -> None:
    """Warn, once per model, of data that were made before their model got room for friction."""
    if address in _warned:
        return
    _warned.add(address)
    warnings.warn(
        "friction does not act in this MjData, which has no room for the friction state: create it "
        "after frictionjoint.attach or load_model",
        RuntimeWarning,
        stacklevel=2,
    )
