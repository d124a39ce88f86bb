"""The EMPS log: a prismatic axis driven by a motor of known force constant (Janot et al. 2019)."""

from pathlib import Path

import numpy as np
from scipy.io import loadmat

from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import check_columns


def is_emps(names: list[str]) -> bool:
    """Whether the columns of a .mat file are those of the benchmark."""
    return {"t", "qm", "qg", "vir", "gtau"} <= set(names)


def read_emps(path: Path) -> JointLog:
    """Read the .mat file; force = gtau times motor voltage."""
    content = loadmat(path)
    get = {name: np.asarray(content[name], dtype=np.float64).ravel() for name in ("t", "qm", "qg")}
    gtau = float(np.ravel(content["gtau"])[0])
    columns = {
        "time_s": get["t"],
        "position_m": get["qm"],
        "target_m": get["qg"],
        "force_n": gtau * np.asarray(content["vir"], dtype=np.float64).ravel(),
    }
    check_columns(path.name, columns, 1)
    gains = {k: float(np.ravel(content[k])[0]) for k in ("kp", "kv") if k in content}
    return JointLog(
        name=path.stem,
        joint="joint",
        time=columns["time_s"],
        position=columns["position_m"],
        torque=columns["force_n"],
        target=columns["target_m"],
        slide=True,
        metadata={"gtau": gtau, **gains},
    )
