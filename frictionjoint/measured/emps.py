"""The EMPS log: a prismatic axis driven by a motor of known force constant (Janot et al. 2019).

Fields of the .mat file: ``t`` s, ``qm`` position m, ``qg`` reference m, ``vir`` motor voltage V,
``gtau`` N/V, controller gains ``kp`` and ``kv``. Force = gtau * vir.
"""

from dataclasses import replace
from pathlib import Path

from frictionjoint.measured.arrays import mat_columns, mat_scalars
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

_COLUMNS = ["t", "qm", "qg", "vir"]


def is_emps(names: list[str]) -> bool:
    """Whether a .mat file has the variable names of the benchmark."""
    return {*_COLUMNS, "gtau"} <= set(names)


def read_emps(path: Path) -> JointLog:
    """Read the .mat file.

    Raises:
        LogError: see `validate`.
    """
    raw = mat_columns(path, _COLUMNS)
    gains = mat_scalars(path, ["gtau"], optional=["kp", "kv"])
    columns = {
        "time_s": raw["t"],
        "position_m": raw["qm"],
        "target_m": raw["qg"],
        "force_n": gains["gtau"] * raw["vir"],
    }
    return replace(log_of(path, "joint", columns), metadata=gains)
