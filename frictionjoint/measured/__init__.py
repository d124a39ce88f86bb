"""Measured logs: formats, validation, derivatives, public data sets."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from frictionjoint.measured.derivatives import Derivatives, differentiate
    from frictionjoint.measured.gaps import split_at_gaps
    from frictionjoint.measured.log import JointLog, split_in_time
    from frictionjoint.measured.readers import read_log
    from frictionjoint.measured.registry import DataSet, get_data, list_data

# Simulations import the effects, which import the log's type: readers and filters load on use.
_HOMES = {
    "DataSet": "registry",
    "Derivatives": "derivatives",
    "JointLog": "log",
    "differentiate": "derivatives",
    "get_data": "registry",
    "list_data": "registry",
    "read_log": "readers",
    "split_at_gaps": "gaps",
    "split_in_time": "log",
}

__all__ = [
    "DataSet",
    "Derivatives",
    "JointLog",
    "differentiate",
    "get_data",
    "list_data",
    "read_log",
    "split_at_gaps",
    "split_in_time",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
