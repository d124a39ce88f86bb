"""The EMPS log: a prismatic axis driven by a motor of known force constant (Janot et al. 2019).

Fields of the .mat file: ``t`` s, ``qm`` position m, ``qg`` reference m, ``vir`` motor voltage V,
``gtau`` N/V, controller gains ``kp`` and ``kv``. Force = gtau * vir.
"""

from pathlib import Path

from frictionjoint.measured.arrays import mat_columns, mat_scalars
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import check_columns, check_moves

_COLUMNS = ["t", "qm", "qg", "vir"]


def is_emps(names: list[str]) -> bool:
    """Whether the names in a .mat file are those of the benchmark."""
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
    check_columns(path.name, columns)
    check_moves(path.name, columns)
    return JointLog(
        name=path.stem,
        joint="joint",
        time=columns["time_s"],
        position=columns["position_m"],
        torque=columns["force_n"],
        target=columns["target_m"],
        slide=True,
        metadata=gains,
    )
