"""All friction laws by name and by number: reading parameters back from files and models."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.errors import ParameterError
from frictionjoint.parameters import Friction, FrictionParameters

_CLASSES: dict[str, type[FrictionParameters]] = {"integrated": FrictionParameters}


def parameters_from_dict(values: Mapping[str, Any]) -> Friction:
    """Parameters of the law that `values` names; the integrated law without a name.

    Raises:
        ParameterError: unknown law, or parameters that it refuses.
    """
    law = values.get("law", "integrated")
    if not isinstance(law, str) or law not in _CLASSES:
        raise ParameterError(f"unknown law {law!r}: known are {', '.join(_CLASSES)}")
    return _CLASSES[law].from_dict(values)


def unpack(block: NDArray[np.float64]) -> Friction:
    """Inverse of ``pack``; the values pass validation again.

    Raises:
        ParameterError: the block belongs to no law, or holds values out of range.
    """
    if len(block) < 1 or block[0] != 1.0:
        raise ParameterError(f"no friction law has the number {block[:1]}")
    return FrictionParameters.unpack(block)
