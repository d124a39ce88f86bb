"""An mjModel given by its address alone, as a C callback receives it."""

from typing import Any

import mujoco
import numpy as np

from frictionjoint.simulate.layout import model_extents, structure


class ModelView:
    """The fields of an mjModel under the names in `mujoco.MjModel`.

    Arrays are views of the model's own memory: it must outlive them, and writing changes it.

    Args:
        address: of the C structure.
    """

    def __init__(self, address: int) -> None:
        self._fields = structure("mjModel").from_address(address)

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._fields, name)
        extents = model_extents().get(name)
        if extents is None:
            return value
        kind, sizes = extents
        shape = [size if isinstance(size, int) else getattr(self._fields, size) for size in sizes]
        if value is None or 0 in shape:
            return np.zeros(shape, dtype=kind)
        array = (kind * int(np.prod(shape))).from_address(value)
        return np.ctypeslib.as_array(array).reshape(shape)


def names_of(model: mujoco.MjModel | ModelView, kind: str) -> list[str]:
    """Names of all objects of a kind, as mjModel abbreviates it ("jnt"), "" for one without."""
    letters = bytes(model.names)
    begins = getattr(model, f"name_{kind}adr")
    return [letters[begin : letters.index(0, begin)].decode() for begin in begins]


def without_tag(name: str, tag: str) -> str | None:
    """A name without its tag, which `MjSpec.attach` may have put behind a prefix; None if there is
    no tag."""
    prefix, own, rest = name.partition(tag)
    return prefix + rest if own else None


def tagged_numerics(model: mujoco.MjModel | ModelView, tag: str) -> dict[str, int]:
    """Address in ``numeric_data`` of each numeric with a tag in its name, by the rest of it."""
    names = (without_tag(name, tag) for name in names_of(model, "numeric"))
    pairs = zip(names, model.numeric_adr, strict=True)
    return {name: int(address) for name, address in pairs if name is not None}
