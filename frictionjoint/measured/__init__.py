"""Measured logs: formats, validation, derivatives, public data sets."""

from frictionjoint.measured.derivatives import Derivatives, differentiate
from frictionjoint.measured.gaps import split_at_gaps
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import read_log
from frictionjoint.measured.registry import DataSet, get_data, list_data

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
