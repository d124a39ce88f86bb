"""All friction laws by name and by number: reading parameters back from files and models."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.errors import ParameterError
from frictionjoint.parameter_checks import require_table
from frictionjoint.parameters import Friction, FrictionParameters
from frictionjoint.rivals import RIVALS

_ALL: tuple[type[Friction], ...] = (FrictionParameters, *RIVALS)
_CLASSES = {cls.law: cls for cls in _ALL}
_NUMBERS = {float(cls.number): cls for cls in _ALL}


def parameters_from_dict(values: Mapping[str, Any]) -> Friction:
    """Parameters of the law that `values` names; the integrated law if it names none.

    Raises:
        ParameterError: unknown law, or parameters that it rejects.
    """
    require_table(values)
    law = values.get("law", "integrated")
    if not isinstance(law, str) or law not in _CLASSES:
        raise ParameterError(f"unknown law {law!r}: known are {', '.join(_CLASSES)}")
    return _CLASSES[law].from_dict(values)


def unpack(block: NDArray[np.float64]) -> Friction:
    """Inverse of ``pack``; the values are validated again.

    Raises:
        ParameterError: the block belongs to no law, or contains values out of range.
    """
    if len(block) < 1 or float(block[0]) not in _NUMBERS:
        raise ParameterError(f"no friction law has the number {block[:1]}")
    return _NUMBERS[float(block[0])].unpack(block)


def require_parameters(parameters: Any, where: str) -> None:
    """Raise TypeError, with the fix, unless these are parameters of a law."""
    if isinstance(parameters, Friction):
        return
    if isinstance(parameters, Mapping):
        fix = "make them with FrictionParameters.from_dict(...)"
    elif isinstance(parameters, str | Path):
        fix = "read the file with frictionjoint.files.read_parameters(path).parameters"
    elif hasattr(parameters, "parameters") and hasattr(parameters, "effects"):
        fix = "give its .parameters, and its .effects as the effects of the joint"
    else:
        fix = "make them with FrictionParameters(...)"
    raise TypeError(f"{where}: {kind_of(parameters)} is not a set of friction parameters: {fix}")


def kind_of(value: Any) -> str:
    """Name of a value's type for a message."""
    kind = type(value)
    return kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__name__}"
